"""Reads students and times from the lists that LMSs export.

The lists map numbers to students, and contain the times at which work was handed in.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import IO, TYPE_CHECKING, Any

import msgspec
import re2
import yaml

from autograder.grading.collecting.systems import GRADESCOPE, LIST_FORMS, ListForm
from autograder.grading.collecting.written_times import read_time
from autograder.grading.table.roster import Identity
from autograder.grading.table.spreadsheet_csv import csv_rows, original

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


@dataclass(frozen=True)
class ListEntry:
    """An entry of a list, about one submission or one person.

    Attributes:
        lms: The system that made the list.
        number: The number or user name that the system also puts into file names; empty if it puts none.
        members: For each member of the group that handed in, the names of this member, the most certain first.
        group: The name of the group that handed in; empty if it is not a group's work.
        when: The time of handing in, in the LMS's own time if it has no time zone; None if the list has no time.
    """

    lms: str
    number: str
    members: tuple[tuple[Identity, ...], ...]
    when: datetime | None = None
    group: str = ""


_SAMPLES = {
    "a.csv": b"identifier,grade,full name,last modified (submission)\nParticipant 1,,Ada,3 October 2025\n",
    GRADESCOPE: b"submission_1:\n  :created_at: 2025-10-03\n  :submitters:\n  - :name: Ada\n",
}
"""One small list of each format. Reading them once loads everything that a desk otherwise loads at its first use."""


def rehearse() -> None:
    """Load everything that :func:`read` needs, because a desk itself cannot open files."""
    for name, data in _SAMPLES.items():
        msgspec.json.encode(_parse_list(name, data))


def read(file: IO[bytes], name: str) -> Iterator[bytes]:
    """Yield the answer about a list, in a desk: the entries as JSON.

    Args:
        file: The list.
        name: The name of the file.
    """
    yield msgspec.json.encode(_parse_list(name, file.read()))


def _parse_list(name: str, data: bytes) -> list[ListEntry] | None:
    """Parse a list; return None if its form is unknown. Call this only in a desk, because the file is not trusted.

    Args:
        name: The name of the file.
        data: The bytes of the file.
    """
    if name == GRADESCOPE:
        return _of_gradescope(data)
    header, *rows = csv_rows(data)[0] or [[]]
    columns = [column.strip().lower() for column in header]
    forms = (one for one in LIST_FORMS if one.number or one.time)
    form = next((one for one in forms if set(one.has) <= set(columns)), None)
    records = [dict(zip(columns, (original(cell.strip()) for cell in row), strict=False)) for row in rows]
    return None if form is None else list(_entries(form, records))


_NUMBER = re2.compile(r"(\d+)(?:\.\w+)?$")


def number_in(value: str) -> str:
    """Return the number at the end of an identifier, such as ``Participant 12345``; empty if there is none."""
    found = _NUMBER.search(value)
    return found[1] if found else ""


def _entries(form: ListForm, records: list[dict[str, str]]) -> Iterator[ListEntry]:
    for record in records:
        number = record.get(form.number, "")
        if form.lms in ("moodle", "canvas", "gradescope"):
            number = number_in(number)
        names = [Identity(form.lms, login=login) for name in form.logins if (login := record.get(name, ""))]
        if called := " ".join(filter(None, (record.get(name, "") for name in form.names))):
            names.append(Identity(form.lms, name=called))
        if names and (number or form.time):
            when, group = read_time(record.get(form.time, "")), record.get(form.group, "")
            yield ListEntry(form.lms, number, (tuple(names),), when, group)


def _of_gradescope(data: bytes) -> list[ListEntry] | None:
    """Read ``submission_metadata.yml``, which contains the student and the time for each submission's folder."""
    try:
        # Load every value as text, so that a number such as 0042 keeps its zeros.
        found = yaml.load(data, Loader=getattr(yaml, "CBaseLoader", yaml.BaseLoader))
    except (yaml.YAMLError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict):
        return None
    entries = []
    for folder, about in found.items():
        number = number_in(_word(folder))
        if number and isinstance(about, dict):
            members = tuple(_member(one) for one in about.get(":submitters") or () if isinstance(one, dict))
            when = read_time(_word(about.get(":created_at")))
            when = when.replace(tzinfo=UTC) if when and when.tzinfo is None else when
            entries.append(ListEntry("gradescope", number, members, when))
    return entries


def _member(submitter: Mapping[str, Any]) -> tuple[Identity, ...]:
    values = {name: _word(submitter.get(f":{name}")) for name in ("sid", "email", "name")}
    logins = [Identity("gradescope", login=values[name]) for name in ("sid", "email") if values[name]]
    return (*logins, Identity("gradescope", name=values["name"])) if values["name"] else tuple(logins)


def _word(value: object) -> str:
    """Return a value that is a text; empty for any other value: a nested list could be larger than the memory."""
    return value.strip() if isinstance(value, str) else ""
