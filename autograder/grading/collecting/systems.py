"""The rows of ``systems.toml``: the names and the lists that learning management systems (LMS) let one download."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import msgspec

EACH = "*"
"""The value of ``points`` if each assignment has a column of its own."""
GRADESCOPE = "submission_metadata.yml"
"""The list that Gradescope puts into its export."""


@dataclass(frozen=True)
class NameForm:
    """A form of names of files or folders. ``systems.toml`` describes the attributes.

    Attributes:
        list: For a system that numbers submissions instead of students, the list that maps numbers to students.
    """

    system: str
    pattern: str
    divide: str = ""
    least_order: int = 0
    needs_file: bool = False
    needs_from: bool = False
    list: str = ""
    samples: tuple[str, ...] = ()


@dataclass(frozen=True)
class ListForm:
    """A form of list, by the names of its columns, in lower case.

    Attributes:
        lms: The system that exports such lists.
        has: The columns by which it is recognized.
        number: The column with the number, or the user name, that is also in the names of files.
        logins: Columns with user names and addresses, the most certain first.
        names: The columns that together are the name, which users choose themselves.
        time: The column with the time at which the work was handed in.
        group: The column with the name of the group that handed in.
        points: The column for the points, or :data:`EACH`; empty if the list has no place for points.
        out_of: The column with the maximum points, in a list with one column for points.
        is_numbered: True if the number is the same for all assignments.
    """

    lms: str
    has: tuple[str, ...]
    number: str = ""
    logins: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    time: str = ""
    group: str = ""
    points: str = ""
    out_of: str = ""
    is_numbered: bool = False

    @property
    def sure(self) -> tuple[str, ...]:
        """The columns that identify a person better than a name does, the most certain first."""
        return (self.number, *self.logins) if self.is_numbered else self.logins


@dataclass(frozen=True)
class _Rows:
    name: tuple[NameForm, ...]
    list: tuple[ListForm, ...]


_ROWS = msgspec.toml.decode(Path(__file__).with_suffix(".toml").read_bytes(), type=_Rows)
NAME_FORMS = {one.system: one for one in _ROWS.name}
"""The forms of names, by their systems."""
LIST_FORMS = _ROWS.list
"""The forms of lists."""
