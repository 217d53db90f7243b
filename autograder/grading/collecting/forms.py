"""The names that learning management systems give to downloads, and the facts in such a name."""

from __future__ import annotations

import itertools
import unicodedata
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING

import re2

from autograder.grading.table.roster import Identity
from autograder.regular_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

FORMS = ("moodle", "blackboard", "brightspace", "canvas", "google", "github", "gradescope")
"""In the order in which they are tried: the one whose names say most about themselves goes first."""

# Ada Lovelace_12345_assignsubmission_file_lab_1_2.ipynb; since 4.1, and with folders before, it is a folder's name.
_MOODLE = re2.compile(r"^(?P<name>[^_]+)_(?P<number>\d+)_assignsubmission_(?:file|onlinetext)_?(?P<file>.*)$")
# lab_1_2_adal_attempt_2025-10-03-14-05-06_lab_1_2.ipynb; without the file, .txt: what the student typed.
# The first attempt in the name is Blackboard's: what is behind it is the student's own.
_BLACKBOARD = re2.compile(
    r"^(?P<item>.+?)_(?P<login>[^_]+)_attempt_(?P<when>\d{4}(?:-\d\d){5})(?:_(?P<file>.+)|\.txt)$"
)
# 12345-67890 - Ada Lovelace - Oct 3, 2025 205 PM, a folder; or, with " - lab_1_2.ipynb" behind it, a file. The date is
# in the language of the course: 3 October, 2025 1405. Some universities have the student's own number in front of the
# name: 12345-67890 - N0123456 - Ada Lovelace- 3 October, 2025 205 PM - lab_1_2.ipynb
_BRIGHTSPACE = re2.compile(
    r"^(?P<number>\d+)-\d+ ?- ?(?P<name>.+?) ?- ?"
    r"(?P<when>(?:[^\d\s,.-]+\.? \d\d?|\d\d?\.? (?:de )?[^\d\s,.-]+\.?),? (?:de )?\d{4} "
    r"\d\d?[:.h]?\d\d(?: ?[AaPp]\.?[Mm]\.?)?)"
    r"(?: ?- ?(?P<file>.+))?$"
)
_STUDENT_NUMBER = re2.compile(r"[A-Za-z]{0,4}\d[\dA-Za-z]{2,}")
# lovelaceada_LATE_123_456_lab_1_2-1.ipynb: the student's number, then the file's
_CANVAS = re2.compile(
    r"^(?P<login>.*?[^\d_].*?)_(?i:(?P<late>LATE)_)?(?P<number>\d+)_(?P<file_number>\d+)_(?P<file>.+)$"
)
# Ada Lovelace - lab_1_2.ipynb; of copies that were made for each student long ago: lab_1_2 - Ada Lovelace.ipynb
_GOOGLE = re2.compile(r"^(?P<name>[^/]*?\S) - (?P<file>.+)$")
# assignment_123_export/submission_456/lab_1_2.ipynb
_GRADESCOPE = re2.compile(r"^submission_(?P<number>\d+)$")
_MOST_MARKS = 10
"""Of a name that can be read in several ways; nobody's has more."""
# What browsers, Canvas and Drive add to a name that is there already, and file managers to a copy.
_COPY_OF = "Copy of "
_MARK = r" ?\((\d{1,6})\)|-(\d{1,6})| - [Cc]opy"
_MARKED = re2.compile(rf"^(?P<base>.+?)(?P<marks>(?:{_MARK})+)$")
_MARKS = re2.compile(_MARK)


@dataclass(frozen=True)
class Found:
    """The facts in the path of a file.

    Attributes:
        identity: Whose it is.
        file: The name that the student gave it.
        when: When it was handed in, in the LMS's own time; None where the name does not say.
        order: Grows with later files of one student, where the LMS numbers files.
        late: Whether the LMS marks it as late.
        readings: Who may be meant where the name can be read in several ways, the longest first; the first who is in
            the class is. Empty where there is one way.
        time: The time as the name has it, also where nobody could read it.
    """

    identity: Identity
    file: str
    when: datetime | None = None
    order: int = 0
    late: bool = False
    readings: tuple[Identity, ...] = ()
    time: str = ""


def read_path(parts: Sequence[str], form: str, is_notebook: Callable[[str], bool]) -> Found | None:
    """The facts in a path of the form of one LMS; None where it is not of that form.

    Args:
        parts: The path's folders and the file, of which none leads upwards.
        form: One of :data:`FORMS`.
        is_notebook: Whether a file of this name is a notebook of the class, for forms that other names resemble.
    """
    parts = [unicodedata.normalize("NFC", part) for part in parts]
    found = _READERS[form](parts)
    if found and form == "google" and is_notebook(found.identity.name):
        found = _with_the_name_last(found)
    if found and form in ("canvas", "google") and found.file != parts[-1] and is_notebook(parts[-1]):
        return None  # lab_1_2_3.ipynb and "lab_1_2 - Copy.ipynb" are a student's own names
    return found


def base_and_number(stem: str) -> tuple[str, int]:
    """A name without what was added because there was one already, and the number that was added."""
    stem, number = name_as_text(stem), 0
    while stem.startswith(_COPY_OF) and stem != _COPY_OF:
        stem, number = stem.removeprefix(_COPY_OF), 1
    if (found := _MARKED.match(stem)) is not None:
        stem = found["base"]
        number = max(number, *(int(one[1] or one[2] or 1) for one in _MARKS.finditer(found["marks"])))
    return stem, number


def _moodle(parts: Sequence[str]) -> Found | None:
    for place, part in enumerate(parts):
        found = _MOODLE.match(part)
        if found is not None:
            is_file = place == len(parts) - 1
            # Of a group's work, or with a group chosen, the group's name is in front: Group A-Ada Lovelace.
            names = [found["name"], *_ends(found["name"], "-")]
            whole, *shorter = (Identity("moodle", found["number"], name=name) for name in names)
            return Found(whole, found["file"] if is_file else parts[-1], readings=(whole, *shorter))
    return None


def _ends(text: str, mark: str) -> list[str]:
    """The ends of a text behind each of its last few marks, the longest first."""
    pieces = text.rsplit(mark, _MOST_MARKS)[1:]
    return [end for start in range(len(pieces)) if (end := mark.join(pieces[start:]).strip())]


def _blackboard(parts: Sequence[str]) -> Found | None:
    for place, part in enumerate(parts):
        found = _BLACKBOARD.match(part)
        if found is not None:
            file = found["file"] if place == len(parts) - 1 else parts[-1]
            when = datetime.strptime(found["when"], "%Y-%m-%d-%H-%M-%S") if _is_date(found["when"]) else None
            # A user name may have the mark in it that is in front of it.
            logins = _ends(f"{found['item']}_{found['login']}", "_") or [found["login"]]
            *longer, usual = (Identity("blackboard", login=login) for login in logins)
            return Found(usual, file or part, when, readings=(*longer, usual), time=found["when"])
    return None


def _is_date(text: str) -> bool:
    try:
        datetime.strptime(text, "%Y-%m-%d-%H-%M-%S")
    except ValueError:
        return False
    return True


def _brightspace(parts: Sequence[str]) -> Found | None:
    for place, part in enumerate(parts):
        found = _BRIGHTSPACE.match(part)
        is_file = place == len(parts) - 1
        if found is not None and (found["file"] is not None) == is_file:
            whole, *others = _of_brightspace(found["number"], found["name"])
            when = _clock_time(found["when"])
            return Found(
                whole, found["file"] or parts[-1], when, readings=(whole, *others), time=found["when"]
            )
    return None


def _of_brightspace(number: str, name: str) -> list[Identity]:
    whole = Identity("brightspace", number, name=name)
    own_number, dash, behind = name.partition(" - ")
    if not dash or not _STUDENT_NUMBER.fullmatch(own_number):
        return [whole]
    return [whole, Identity("brightspace", login=own_number), Identity("brightspace", number, name=behind)]


def _clock_time(text: str) -> datetime | None:
    """``Oct 3, 2025 205 PM`` or ``3 October, 2025 1405``: the colon cannot be in a folder's name."""
    words = text.replace(",", "").replace(".", "").replace(":", "").upper().replace("SEPT ", "SEP ")
    half = next((half for half in ("AM", "PM") if words.endswith(half)), "")
    *date, clock = words.removesuffix(half).split()
    forms = [f"{date_form} %Y {'%I%M %p' if half else '%H%M'}" for date_form in _DATES]
    for form in forms:
        try:
            return datetime.strptime(f"{' '.join(date)} {clock.rjust(4, '0')} {half}".strip(), form)
        except ValueError:
            continue
    return None


_DATES = ("%b %d", "%B %d", "%d %b", "%d %B")


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
    return _of_google(found["name"], found["file"])


def _of_google(name: str, file: str) -> Found:
    bare = name.removeprefix(_COPY_OF)
    identity = Identity("google", login=bare if "@" in bare else "", name=bare)
    return Found(identity, file)


def _with_the_name_last(found: Found) -> Found:
    stem, dot, suffix = found.file.rpartition(".")
    return _of_google(base_and_number(stem)[0], f"{found.identity.name}{dot}{suffix}") if stem else found


def _github(parts: Sequence[str]) -> Found | None:
    """``lab-1-2-submissions/lab-1-2-adalove/lab_1_2.ipynb``, as ``gh classroom clone`` makes it."""
    for above, part in itertools.pairwise(parts[:-1]):
        slug, dash, _ = above.rpartition("-")
        if dash and above == f"{slug}-submissions" and part.startswith(f"{slug}-"):
            login = part.removeprefix(f"{slug}-")
            # Where somebody had a repository of that name already, GitHub Classroom adds a number.
            logins = dict.fromkeys((login, base_and_number(login)[0]))
            whole, *others = (Identity("github", login=one) for one in logins)
            return Found(whole, parts[-1], readings=(whole, *others))
    return None


def _gradescope(parts: Sequence[str]) -> Found | None:
    """The facts in a path of Gradescope's: only the list in the export says who a number is."""
    found = next(filter(None, map(_GRADESCOPE.match, parts[:2])), None) if len(parts) > 1 else None
    return Found(Identity("gradescope", found["number"]), parts[-1]) if found else None


def plain(parts: Sequence[str]) -> list[Found]:
    """The facts in a path with folders that are students' ids or names, or end with a user name of GitHub's.

    Repositories that were downloaded one by one are called ``lab-1-2-adalove-main``; Classroom Assistant makes
    folders with user names.
    """
    parts = [unicodedata.normalize("NFC", part) for part in parts]
    found = Found(Identity(), parts[-1])
    ways = []
    for part in parts[:-1]:
        bare = next((part.removesuffix(end) for end in _BRANCHES if part.endswith(end)), part)
        repository = [Identity("github", number=login) for login in (bare, *_ends(bare, "-"))]
        ways.append(replace(found, readings=(Identity(login=part, name=part), *repository)))
    return ways


_BRANCHES = ("-main", "-master")
_READERS = {
    "moodle": _moodle,
    "blackboard": _blackboard,
    "brightspace": _brightspace,
    "canvas": _canvas,
    "google": _google,
    "github": _github,
    "gradescope": _gradescope,
}
