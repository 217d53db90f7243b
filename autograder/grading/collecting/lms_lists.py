"""Lists that LMSs export: ``collect`` reads students and times from them, and ``export --into`` fills points in.

The lists map numbers to students, and contain the times at which work was handed in.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import re2
import yaml

from autograder.grading.collecting.submitted_file_names import read_time
from autograder.grading.table.roster import Identity
from autograder.grading.table.spreadsheet_csv import csv_rows, original

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


EACH = "*"
"""The value of ``points`` if each assignment has a column of its own."""


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
        points: The column for the points, or :data:`EACH`; empty if the list has no place for points.
        is_numbered: True if the number is the same for all assignments.
    """

    lms: str
    has: tuple[str, ...]
    number: str = ""
    logins: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    time: str = ""
    points: str = ""
    is_numbered: bool = False

    @property
    def sure(self) -> tuple[str, ...]:
        """The columns that identify a person better than a name does, the most certain first."""
        return (self.number, *self.logins) if self.is_numbered else self.logins


LIST_FORMS = (
    # Moodle's grading worksheet. Its identifiers look like "Participant 12345", but the word depends on the language.
    ListForm(
        "moodle",
        ("identifier", "grade"),
        "identifier",
        ("id number", "username", "email address"),
        ("full name",),
        "last modified (submission)",
        "grade",
    ),
    ListForm(
        "moodle",
        ("id", "vollständiger name", "bewertung"),
        "id",
        ("matrikelnummer", "id-nummer", "anmeldename", "e-mail-adresse"),
        ("vollständiger name",),
        "zuletzt geändert (abgabe)",
        "bewertung",
    ),
    ListForm(
        "moodle",
        ("identifiant", "nom complet", "note"),
        "identifiant",
        ("numéro d'identification", "nom d'utilisateur", "adresse de courriel"),
        ("nom complet",),
        "dernière modification (travail remis)",
        "note",
    ),
    ListForm(
        "canvas",
        ("student", "id", "section"),
        "id",
        ("sis user id", "sis login id"),
        ("student",),
        points=EACH,
        is_numbered=True,
    ),
    # A list of submissions from Canvas, whose columns have the field names of Canvas's API.
    ListForm(
        "canvas",
        ("user_id", "submitted_at"),
        "user_id",
        ("login_id", "sis_user_id"),
        ("name",),
        "submitted_at",
    ),
    ListForm(
        "github",
        ("github_username", "roster_identifier"),
        "github_username",
        ("roster_identifier",),
        ("roster_identifier",),
        "submission_timestamp",
    ),
    # Gradescope's scores of one assignment.
    ListForm(
        "gradescope",
        ("sid", "submission time"),
        "submission id",
        ("sid", "email"),
        ("first name", "last name"),
        "submission time",
    ),
    ListForm(
        "brightspace",
        ("orgdefinedid", "end-of-line indicator"),
        logins=("username", "orgdefinedid"),
        points=EACH,
    ),
    ListForm("blackboard", ("username", "last name"), logins=("username",), points=EACH),
    ListForm(
        "sakai", ("student id", "student name"), logins=("student id",), names=("student name",), points=EACH
    ),
)
GRADESCOPE = "submission_metadata.yml"
"""The list that Gradescope puts into its export."""


@dataclass(frozen=True)
class ListEntry:
    """An entry of a list, about one submission or one person.

    Attributes:
        lms: The system that made the list.
        number: The number or user name that the system also puts into file names; empty if it puts none.
        members: For each member of the group that handed in, the names of this member, the most certain first.
        when: The time of handing in, in the LMS's own time if it has no time zone; None if the list has no time.
    """

    lms: str
    number: str
    members: tuple[tuple[Identity, ...], ...]
    when: datetime | None = None


def parse_list(name: str, data: bytes) -> list[ListEntry] | None:
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


def _entries(form: ListForm, records: list[dict[str, str]]) -> Iterator[ListEntry]:
    for record in records:
        number = record.get(form.number, "")
        if form.lms in ("moodle", "canvas", "gradescope"):
            found = _NUMBER.search(number)
            number = found[1] if found else ""
        names = [Identity(form.lms, login=login) for name in form.logins if (login := record.get(name, ""))]
        if called := " ".join(filter(None, (record.get(name, "") for name in form.names))):
            names.append(Identity(form.lms, name=called))
        if names and (number or form.time):
            yield ListEntry(form.lms, number, (tuple(names),), read_time(record.get(form.time, "")))


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
        number = _NUMBER.search(_word(folder))
        if number is not None and isinstance(about, dict):
            members = tuple(_member(one) for one in about.get(":submitters") or () if isinstance(one, dict))
            when = read_time(_word(about.get(":created_at")))
            when = when.replace(tzinfo=UTC) if when and when.tzinfo is None else when
            entries.append(ListEntry("gradescope", number[1], members, when))
    return entries


def _member(submitter: Mapping[str, Any]) -> tuple[Identity, ...]:
    values = {name: _word(submitter.get(f":{name}")) for name in ("sid", "email", "name")}
    logins = [Identity("gradescope", login=values[name]) for name in ("sid", "email") if values[name]]
    return (*logins, Identity("gradescope", name=values["name"])) if values["name"] else tuple(logins)


def _word(value: object) -> str:
    """Return a value that is a text; empty for any other value: a nested list could be larger than the memory."""
    return value.strip() if isinstance(value, str) else ""
