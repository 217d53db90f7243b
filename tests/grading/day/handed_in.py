"""A class that hands in through five learning management systems and by hand, with every oddity that real work has."""

from __future__ import annotations

import sys
import unicodedata
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parent))
from downloads import BOMB, Link, write_zip, zipped

from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

FIRST = ("Ada", "José", "Zoë", "Bär", "Søren", "Łucja", "Chloé", "Nguyễn", "Eve", "Olu")
LAST = ("Lovelace", "Núñez", "O'Neill", "Müller", "Ørsted", "Kowalska", "Dupont", "Anh")
DUE = datetime(2026, 1, 10, 12)
"""In UTC, as all times here."""
BY_HAND = cases(__file__, "BY_HAND")
"""How work lies in ``submitted`` that somebody has put there, and the student's id where that is the oddity."""
SYSTEMS = ("moodle", "canvas", "blackboard", "brightspace", "gradescope")
"""The systems that students hand in through, one after the other."""
ODDITIES = {
    1: "twice",
    5: "zip",
    6: "text",
    10: "folder",
    11: "two notebooks",
    15: "zip in a zip",
    16: "rar",
    21: "py",
    25: "name of another",
    26: "tar.gz",
    31: "other lab",
    32: "excused",
}
"""What is odd about the work of a lab, by the student's place; it follows from the place which system it is."""
UNPLACED = ("rar", "py", "tar.gz", "other lab")
"""Oddities with which work has no place."""


@dataclass(frozen=True)
class Pupil:
    """A student of the made class.

    Attributes:
        place: Counted from 0; everything else follows from it.
        id: The student's id.
        first: First name.
        last: Last name.
        lms: Through which system the work comes; empty for who hands in nothing, or by hand.
        late: Whether it comes after it was due.
        habit: How it was put into ``submitted`` by hand, one of :data:`BY_HAND`; empty where it was not.
        oddity: What is odd about the lab, one of :data:`ODDITIES`; empty where nothing is.
    """

    place: int
    id: str
    first: str
    last: str
    lms: str
    late: bool
    habit: str = ""
    oddity: str = ""

    @property
    def is_collected(self) -> bool:
        """Whether the lab comes through a system and has a place."""
        return bool(self.lms) and self.oddity not in (*UNPLACED, "excused")

    @property
    def hands_in(self) -> bool:
        """Whether the lab comes to its place at all."""
        return self.is_collected or bool(self.habit)

    @property
    def when(self) -> datetime:
        """When the work comes."""
        return DUE + timedelta(hours=30 if self.late else -self.place - 1)


def pupils(count: int) -> list[Pupil]:
    """The class; the last one hands in nothing, those before by hand; three are late, one as a list of times says."""
    found = []
    habits = dict(enumerate(BY_HAND, count - 1 - len(BY_HAND)))
    for place in range(count):
        habit = habits.get(place, "")
        lms = "" if place >= min(habits) else SYSTEMS[place % len(SYSTEMS)]
        oddity = ODDITIES.get(place, "") if lms else ""
        named = place - len(SYSTEMS) if oddity == "name of another" else place
        first, last = (
            FIRST[named % len(FIRST)],
            f"{LAST[named % len(LAST)]}{'' if named < 8 else ' ' + 'abcdefgh'[named // 8]}",
        )
        id_ = BY_HAND.get(habit) or f"s{place:02}"
        found.append(Pupil(place, id_, first, last, lms, place in (1, 2, 3), habit, oddity))
    return found


def put_by_hand(submitted: Path, class_: list[Pupil], work: Callable[[Pupil, bool], str]) -> None:
    """Put work into ``submitted`` as people do it: a little beside its place, and some that is nobody's.

    Args:
        submitted: That folder of a class.
        class_: Of whom some hand in so.
        work: A student's notebook; of an earlier attempt where the flag is set.
    """
    for pupil in class_:
        if not pupil.habit:
            continue
        name = unicodedata.normalize("NFD", pupil.id) if pupil.habit == "decomposed" else pupil.id
        folder = submitted / name if pupil.habit == "too high" else submitted / name / "lab_1_2"
        folder.mkdir(parents=True)
        file = "lab_1_2 (1).ipynb" if pupil.habit == "numbered alone" else "lab_1_2.ipynb"
        (folder / file).write_text(work(pupil, False), encoding="utf-8")
        if pupil.habit == "numbered beside":
            (folder / "lab_1_2 (1).ipynb").write_text(work(pupil, True), encoding="utf-8")
    (submitted / "lab_1_2.ipynb").write_text(work(class_[0], True), encoding="utf-8")
    write_zip(submitted / "all.zip", {"lab_1_2.ipynb": work(class_[0], True)})


def hand_in(
    folder: Path,
    class_: list[Pupil],
    work: Callable[[Pupil, bool], str],
    assignment: str = "lab_1_2",
    *,
    strange: bool = True,
) -> list[Path]:
    """Write what an instructor downloads.

    Args:
        folder: Where to.
        class_: Who hands in.
        work: A student's notebook; of an earlier attempt where the flag is set.
        assignment: What is handed in.
        strange: Put in what is nobody's, and what is hostile.

    Returns:
        The archives, and Moodle's grading worksheet, which tells two of one name apart.
    """
    archives: dict[str, dict[str, bytes | str]] = {name: {} for name in SYSTEMS}
    for pupil in class_:
        if pupil.lms and not (strange and pupil.oddity == "excused"):
            odd = pupil if strange else replace(pupil, oddity="")
            archives[pupil.lms] |= _FORMS[pupil.lms](odd, work, assignment)
    if strange:
        _put_strange(archives, class_, work)
    archives["gradescope"][f"{_EXPORT}/submission_metadata.yml"] = "".join(
        f"submission_{3000 + one.place}:\n  :submitters:\n  - :name: {one.first} {one.last}\n"
        f"    :email: {one.id}@uni.example\n  :created_at: {one.when:%Y-%m-%d %H:%M:%S}.5 Z\n"
        for one in class_
        if one.lms == "gradescope"
    )
    worksheet = folder / "Grades.csv"
    lines = ["Identifier,Full name,Email address,Grade"]
    lines += [
        f"Participant {500 + one.place},{one.first} {one.last},{one.id}@uni.example,"
        for one in class_
        if one.lms == "moodle"
    ]
    worksheet.write_text("\n".join(lines), encoding="utf-8")
    return [*(write_zip(folder / f"{name}.zip", files) for name, files in archives.items()), worksheet]


def times(class_: list[Pupil]) -> str:
    """Canvas's list of submissions, which says when those came that its names call late."""
    lines = [
        f"{1000 + one.place},{one.when:%Y-%m-%dT%H:%M:%SZ},{one.id}"
        for one in class_
        if one.lms == "canvas" and one.late
    ]
    return "\n".join(["user_id,submitted_at,login_id", *lines]) + "\n"


def _put_strange(
    archives: dict[str, dict[str, bytes | str]], class_: list[Pupil], work: Callable[[Pupil, bool], str]
) -> None:
    archives["moodle"]["Guest User_999_assignsubmission_file_lab_1_2.ipynb"] = work(class_[0], False)
    first, second = class_[:2]
    bomb = f"{first.first} {first.last}_{500 + first.place}_assignsubmission_file_more.zip"
    archives["moodle"][bomb] = zipped({"lab_1_2.ipynb": BOMB})
    archives["canvas"]["../../evil_1_2_lab_1_2.ipynb"] = "out"
    archives["canvas"][f"x_{1000 + second.place}_9999_lab_1_2.ipynb"] = Link("/etc/passwd")


def roster(class_: list[Pupil]) -> str:
    """The list of students."""
    lines = ["id,first_name,last_name,email,canvas,excused"]
    lines += [
        f"{one.id},{one.first},{one.last},{one.id}@uni.example,{1000 + one.place},"
        f"{'lab_1_2' if one.oddity == 'excused' else ''}"
        for one in class_
    ]
    return "\n".join(lines) + "\n"


def _moodle(pupil: Pupil, work: Callable[[Pupil, bool], str], assignment: str) -> dict[str, bytes | str]:
    name = f"{pupil.first} {pupil.last}_{500 + pupil.place}_assignsubmission_file"
    zip_ = zipped({f"in/{assignment} (2).ipynb": work(pupil, False), "in/a.txt": "x"})
    if pupil.oddity == "zip":
        return {f"{name}_my work.zip": zip_}
    if pupil.oddity == "zip in a zip":
        return {f"{name}_all.zip": zipped({"course/my work.zip": zip_})}
    if pupil.oddity == "folder":
        return {f"{name}/{assignment}.ipynb": work(pupil, False)}
    return {unicodedata.normalize("NFD", f"{name}_{assignment}.ipynb"): work(pupil, False)}


def _canvas(pupil: Pupil, work: Callable[[Pupil, bool], str], assignment: str) -> dict[str, bytes | str]:
    login = "".join(c for c in f"{pupil.last}{pupil.first}".lower() if c.isalnum())
    name = f"{login}_{1000 + pupil.place}_"
    first, second = (f"{name}{number + pupil.place}_{assignment}" for number in (8000, 9000))
    kinds: dict[str, dict[str, bytes | str]] = {
        "twice": {f"{first}.ipynb": work(pupil, True), f"{second}-1.ipynb": work(pupil, False)},
        "text": {f"{second}.ipynb.txt": work(pupil, False)},
        "two notebooks": {f"{first}.ipynb": work(pupil, False), f"{second}_old.ipynb": work(pupil, True)},
        "rar": {f"{second}.rar": b"Rar!\x1a\x07\x00"},
        "tar.gz": {f"{second}.tar.gz": b"\x1f\x8b"},
        "py": {f"{second}.py": "print()"},
    }
    return kinds.get(pupil.oddity, {f"{second}-1.ipynb": work(pupil, False)})


def _blackboard(pupil: Pupil, work: Callable[[Pupil, bool], str], assignment: str) -> dict[str, bytes | str]:
    def name(when: datetime) -> str:
        return f"Lab 1.2_{pupil.id}_attempt_{when:%Y-%m-%d-%H-%M-%S}"

    before = pupil.when - timedelta(days=1)
    return {
        f"{name(pupil.when)}_{assignment}.ipynb": work(pupil, False),
        f"{name(pupil.when)}.txt": "Name: somebody",
        f"{name(before)}_{assignment}.ipynb": work(pupil, True),
    }


def _brightspace(pupil: Pupil, work: Callable[[Pupil, bool], str], assignment: str) -> dict[str, bytes | str]:
    clock = f"{pupil.when:%I%M %p}".lstrip("0")
    when = f"{pupil.when:%b} {pupil.when.day}, {pupil.when:%Y} {clock}"
    folder = f"{700 + pupil.place}-42 - {pupil.first} {pupil.last} - {when}"
    return {f"{folder}/{assignment} (1).ipynb": work(pupil, False), "index.html": "<html>"}


def _gradescope(pupil: Pupil, work: Callable[[Pupil, bool], str], assignment: str) -> dict[str, bytes | str]:
    return {f"{_EXPORT}/submission_{3000 + pupil.place}/{assignment}.ipynb": work(pupil, False)}


_EXPORT = "assignment_80_export"
_FORMS = dict(zip(SYSTEMS, (_moodle, _canvas, _blackboard, _brightspace, _gradescope), strict=True))
