"""Lists that come with a download: they map numbers to students, and contain times of handing in."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from datetime import UTC
from typing import TYPE_CHECKING, Any

import re2
import yaml

from autograder.grading.collecting.lms_file_names import read_time
from autograder.grading.reporting.spreadsheet import csv_rows
from autograder.grading.table.roster import Identity

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from datetime import datetime

GRADESCOPE = "submission_metadata.yml"
"""The name of the list that Gradescope puts into its export."""
LARGEST_OF_GRADESCOPE = 4_000_000
"""The maximum size of Gradescope's list in bytes: two thousand for each of two thousand students. Each byte takes a
hundred bytes of memory when parsed.
"""
_NUMBER = re2.compile(r"(\d+)(?:\.\w+)?$")


@dataclass(frozen=True)
class Entry:
    """An entry of a list, about one submission or one person.

    Attributes:
        lms: The system that made the list.
        number: The number or user name that file names contain as well; empty if they contain none.
        members: For each member of the group that handed in, the names of this member, the most certain first.
        when: The time of handing in, in the LMS's own time if it has no time zone; None if the list has no time.
    """

    lms: str
    number: str
    members: tuple[tuple[Identity, ...], ...]
    when: datetime | None = None


@dataclass(frozen=True)
class _Form:
    """A kind of list, described by the names of its columns in lower case.

    Attributes:
        lms: The system that writes the list.
        has: The columns by which the list is recognized.
        number: The column that contains :attr:`Entry.number`.
        logins: The columns with user names and addresses.
        names: The columns that together contain the name.
        time: The column that contains the time.
    """

    lms: str
    has: tuple[str, ...]
    number: str = ""
    logins: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    time: str = ""


_FORMS = (
    # Moodle's grading worksheet. Its identifiers are "Participant 12345", with other words in other languages.
    _Form(
        "moodle",
        ("identifier", "grade"),
        "identifier",
        ("id number", "username", "email address"),
        ("full name",),
        "last modified (submission)",
    ),
    _Form(
        "moodle",
        ("id", "vollständiger name", "bewertung"),
        "id",
        ("matrikelnummer", "id-nummer", "anmeldename", "e-mail-adresse"),
        ("vollständiger name",),
        "zuletzt geändert (abgabe)",
    ),
    _Form(
        "moodle",
        ("identifiant", "nom complet"),
        "identifiant",
        ("numéro d'identification", "nom d'utilisateur", "adresse de courriel"),
        ("nom complet",),
        "dernière modification (travail remis)",
    ),
    _Form("canvas", ("student", "id", "section"), "id", ("sis user id", "sis login id"), ("student",)),
    # Canvas's submissions, with the column names of its programming interface.
    _Form(
        "canvas",
        ("user_id", "submitted_at"),
        "user_id",
        ("login_id", "sis_user_id"),
        ("name",),
        "submitted_at",
    ),
    _Form(
        "github",
        ("github_username", "roster_identifier"),
        "github_username",
        ("roster_identifier",),
        ("roster_identifier",),
        "submission_timestamp",
    ),
    # The scores of an assignment in Gradescope.
    _Form(
        "gradescope",
        ("sid", "submission time"),
        "submission id",
        ("sid", "email"),
        ("first name", "last name"),
        "submission time",
    ),
)


def read_list(name: str, data: bytes) -> list[Entry] | None:
    """Return the entries of a list; None if the kind of list is unknown.

    Args:
        name: The name of the file.
        data: The bytes of the file.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None
    if name == GRADESCOPE:
        return _of_gradescope(text)
    try:
        header, *rows = csv_rows(text) or [[]]
    except csv.Error:
        return None
    columns = [column.strip().lower() for column in header]
    records = [dict(zip(columns, (cell.strip() for cell in row), strict=False)) for row in rows]
    form = next((form for form in _FORMS if set(form.has) <= set(columns)), None)
    return None if form is None else list(_entries(form, records))


def _entries(form: _Form, records: list[dict[str, str]]) -> Iterator[Entry]:
    for record in records:
        number = record.get(form.number, "")
        if form.lms in ("moodle", "canvas", "gradescope"):
            found = _NUMBER.search(number)
            number = found[1] if found else ""
        names = [Identity(form.lms, login=login) for name in form.logins if (login := record.get(name, ""))]
        if called := " ".join(filter(None, (record.get(name, "") for name in form.names))):
            names.append(Identity(form.lms, name=called))
        if names and (number or form.time):
            yield Entry(form.lms, number, (tuple(names),), read_time(record.get(form.time, "")))


def _of_gradescope(text: str) -> list[Entry] | None:
    """Read ``submission_metadata.yml``, which contains the student and the time for the folder of each submission."""
    try:
        # Every value stays text, so that no number loses its zeros, and no text becomes longer than it was typed.
        found = yaml.load(text, Loader=getattr(yaml, "CBaseLoader", yaml.BaseLoader))
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
            entries.append(Entry("gradescope", number[1], members, when))
    return entries


def _member(submitter: Mapping[str, Any]) -> tuple[Identity, ...]:
    values = {name: _word(submitter.get(f":{name}")) for name in ("sid", "email", "name")}
    logins = [Identity("gradescope", login=values[name]) for name in ("sid", "email") if values[name]]
    return (*logins, Identity("gradescope", name=values["name"])) if values["name"] else tuple(logins)


def _word(value: object) -> str:
    """Return a word of the list; empty for a nested list in its place, which could be larger than any memory."""
    return value.strip() if isinstance(value, str) else ""
