"""Lists that come with a download: they say who a number is, and when work was handed in.

Three are known by their columns: Moodle's grading worksheet, Canvas's gradebook, GitHub Classroom's grades.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import re2

from autograder.grading.table.roster import Identity

if TYPE_CHECKING:
    from collections.abc import Mapping

_NUMBER = re2.compile(r"(\d+)$")
_CLOCK = re2.compile(r"^(\d{1,2}):(\d\d) ?([AaPp][Mm])?$")


@dataclass(frozen=True)
class LmsList:
    """What a list says.

    Attributes:
        lms: Which system it is from.
        people: Other names of who has a number or a login there, the surest first.
        times: When they handed in, in the LMS's own time where the time has no zone.
    """

    lms: str
    people: Mapping[str, tuple[Identity, ...]] = field(default_factory=dict)
    times: Mapping[str, datetime] = field(default_factory=dict)


def read_list(data: bytes) -> LmsList | None:
    """Read a CSV file; None where it is none of the lists that are known."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None
    rows = list(csv.reader(io.StringIO(text)))
    if not rows:
        return None
    header = [name.strip() for name in rows[0]]
    records = [dict(zip(header, row, strict=False)) for row in rows[1:]]
    for columns, read in _KINDS.items():
        if set(columns) <= set(header):
            return read(records)
    return None


def _moodle(records: list[dict[str, str]]) -> LmsList:
    people, times = {}, {}
    for record in records:
        number = _NUMBER.search(record["Identifier"])
        if number is None:
            continue
        logins = (record.get(name, "").strip() for name in ("ID number", "Username", "Email address"))
        known = [Identity("moodle", login=login) for login in logins if login]
        people[number[1]] = (*known, Identity("moodle", name=record.get("Full name", "")))
        when = _spoken(record.get("Last modified (submission)", ""))
        if when is not None:
            times[number[1]] = when
    return LmsList("moodle", people, times)


def _canvas(records: list[dict[str, str]]) -> LmsList:
    people = {}
    for record in records:
        if record["ID"].strip().isdigit():
            logins = (record.get(name, "").strip() for name in ("SIS User ID", "SIS Login ID"))
            known = [Identity("canvas", login=login) for login in logins if login]
            people[record["ID"].strip()] = (*known, Identity("canvas", name=record["Student"]))
    return LmsList("canvas", people)


def _github(records: list[dict[str, str]]) -> LmsList:
    people, times = {}, {}
    for record in records:
        login = record["github_username"].strip()
        roster = record["roster_identifier"].strip()
        people[login] = (Identity("github", login=roster), Identity("github", name=roster))
        when = _iso(record.get("submission_timestamp", "").strip())
        if when is not None:
            times[login] = when
    return LmsList("github", people, times)


_KINDS = {
    ("Identifier", "Grade"): _moodle,
    ("Student", "ID", "Section"): _canvas,
    ("github_username", "roster_identifier"): _github,
}


def _spoken(text: str) -> datetime | None:
    """``Friday, 3 October 2025, 2:05 PM``, as an English Moodle writes it."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) < 2:
        return None
    clock = _CLOCK.match(parts[-1])
    if clock is None:
        return None
    hour, minute = int(clock[1]), int(clock[2])
    if clock[3]:
        hour = hour % 12 + (12 if clock[3].lower() == "pm" else 0)
    try:
        return datetime.strptime(parts[-2], "%d %B %Y").replace(hour=hour, minute=minute)
    except ValueError:
        return None


def _iso(text: str) -> datetime | None:
    for form in (None, "%Y-%m-%d %H:%M:%S %Z"):
        try:
            when = datetime.fromisoformat(text) if form is None else datetime.strptime(text, form)
        except ValueError:
            continue
        return when if when.tzinfo or form is None else when.replace(tzinfo=UTC)
    return None
