"""How learning management systems name what they let an instructor download, and what such a name says."""

from __future__ import annotations

import itertools
import unicodedata
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING

import re2

from autograder.grading.table.roster import Identity

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

FORMS = ("moodle", "blackboard", "brightspace", "canvas", "google", "github")
"""In the order in which they are tried: the one whose names say most about themselves goes first."""

# Ada Lovelace_12345_assignsubmission_file_lab_1_2.ipynb; since 4.1, and with folders before, it is a folder's name.
_MOODLE = re2.compile(r"^(?P<name>[^_]+)_(?P<number>\d+)_assignsubmission_(?:file|onlinetext)_?(?P<file>.*)$")
# lab_1_2_adal_attempt_2025-10-03-14-05-06_lab_1_2.ipynb; without the file, .txt: what the student typed.
_BLACKBOARD = re2.compile(
    r"^(?P<item>.+)_(?P<login>[^_]+)_attempt_(?P<when>\d{4}(?:-\d\d){5})(?:_(?P<file>.+)|\.txt)$"
)
# 12345-67890 - Ada Lovelace - Oct 3, 2025 205 PM
_BRIGHTSPACE = re2.compile(
    r"^(?P<number>\d+)-\d+ ?- ?(?P<name>.+?) ?- ?(?P<when>[A-Za-z]{3,9} \d{1,2}, \d{4} \d{1,2}:?\d\d ?[AaPp][Mm])$"
)
# lovelaceada_LATE_123_456_lab_1_2-1.ipynb: the student's number, then the file's
_CANVAS = re2.compile(
    r"^(?P<login>.*?[^\d_].*?)_(?P<late>LATE_)?(?P<number>\d+)_(?P<file_number>\d+)_(?P<file>.+)$"
)
# Ada Lovelace - lab_1_2.ipynb
_GOOGLE = re2.compile(r"^(?P<name>[^/]*?\S) - (?P<file>.+)$")
# What browsers, Canvas and Drive add to a name that is there already, and file managers to a copy.
_NUMBERED = re2.compile(r"^(?P<base>.+?)(?: ?\((?P<in_brackets>\d{1,6})\)|-(?P<behind>\d{1,6})| - [Cc]opy)$")


@dataclass(frozen=True)
class Found:
    """What the path of a file says.

    Attributes:
        identity: Whose it is.
        file: The name that the student gave it.
        when: When it was handed in, in the LMS's own time; None where the name does not say.
        order: Grows with later files of one student, where the LMS numbers files.
        late: Whether the LMS marks it as late.
    """

    identity: Identity
    file: str
    when: datetime | None = None
    order: int = 0
    late: bool = False


def read_path(parts: Sequence[str], form: str, is_notebook: Callable[[str], bool]) -> Found | None:
    """What a path says in the form of one LMS; None where it is not of that form.

    Args:
        parts: The path's folders and the file, of which none leads upwards.
        form: One of :data:`FORMS`.
        is_notebook: Whether a file of this name is a notebook of the class, for forms that other names resemble.
    """
    parts = [unicodedata.normalize("NFC", part) for part in parts]
    found = _READERS[form](parts)
    if found and form in ("canvas", "google") and found.file != parts[-1] and is_notebook(parts[-1]):
        return None  # lab_1_2_3.ipynb and "lab_1_2 - Copy.ipynb" are a student's own names
    return found


def base_and_number(stem: str) -> tuple[str, int]:
    """A name without what was added because there was one already, and the number that was added."""
    number = 0
    while (found := _NUMBERED.match(stem)) is not None:
        stem = found["base"]
        number = max(number, int(found["in_brackets"] or found["behind"] or 1))
    return stem, number


def _moodle(parts: Sequence[str]) -> Found | None:
    for place, part in enumerate(parts):
        found = _MOODLE.match(part)
        if found is not None:
            is_file = place == len(parts) - 1
            identity = Identity("moodle", found["number"], name=found["name"])
            return Found(identity, found["file"] if is_file else parts[-1])
    return None


def _blackboard(parts: Sequence[str]) -> Found | None:
    for place, part in enumerate(parts):
        found = _BLACKBOARD.match(part)
        if found is not None:
            file = found["file"] if place == len(parts) - 1 else parts[-1]
            when = datetime.strptime(found["when"], "%Y-%m-%d-%H-%M-%S") if _is_date(found["when"]) else None
            return Found(Identity("blackboard", login=found["login"]), file or part, when)
    return None


def _is_date(text: str) -> bool:
    try:
        datetime.strptime(text, "%Y-%m-%d-%H-%M-%S")
    except ValueError:
        return False
    return True


def _brightspace(parts: Sequence[str]) -> Found | None:
    for part in parts[:-1]:
        found = _BRIGHTSPACE.match(part)
        if found is not None:
            identity = Identity("brightspace", found["number"], name=found["name"])
            return Found(identity, parts[-1], _twelve_hours(found["when"]))
    return None


def _twelve_hours(text: str) -> datetime | None:
    """``Oct 3, 2025 205 PM``: the colon cannot stand in a folder's name."""
    date, _, clock = text.replace(":", "").replace(" AM", "AM").replace(" PM", "PM").rpartition(" ")
    digits = clock[:-2].rjust(4, "0")
    for month in ("%b", "%B"):
        try:
            return datetime.strptime(f"{date} {digits} {clock[-2:]}", f"{month} %d, %Y %I%M %p")
        except ValueError:
            continue
    return None


def _canvas(parts: Sequence[str]) -> Found | None:
    for place, part in enumerate(parts):
        found = _CANVAS.match(part)
        if found is None:
            continue
        file = found["file"] if place == len(parts) - 1 else parts[-1]
        identity = Identity("canvas", found["number"], login=found["login"])
        return Found(identity, file, order=int(found["file_number"]), late=bool(found["late"]))
    return None


def _google(parts: Sequence[str]) -> Found | None:
    found = _GOOGLE.match(parts[-1])
    if found is None:
        return None
    name, file = found["name"], found["file"]
    return Found(Identity("google", login=name if "@" in name else "", name=name), file)


def _github(parts: Sequence[str]) -> Found | None:
    """``lab-1-2-submissions/lab-1-2-adalove/lab_1_2.ipynb``, as ``gh classroom clone`` makes it."""
    for above, part in itertools.pairwise(parts[:-1]):
        slug, dash, _ = above.rpartition("-")
        if dash and above == f"{slug}-submissions" and part.startswith(f"{slug}-"):
            return Found(Identity("github", login=part.removeprefix(f"{slug}-")), parts[-1])
    return None


def plain(parts: Sequence[str]) -> list[Found]:
    """What a path says in which folders have students' ids or names."""
    parts = [unicodedata.normalize("NFC", part) for part in parts]
    found = Found(Identity(), parts[-1])
    return [replace(found, identity=Identity(login=part, name=part)) for part in parts[:-1]]


_READERS = {
    "moodle": _moodle,
    "blackboard": _blackboard,
    "brightspace": _brightspace,
    "canvas": _canvas,
    "google": _google,
    "github": _github,
}
