"""A class that hands in through four learning management systems and by hand, with every oddity that real work has.

``python tests/grading/day/handed_in.py NOTEBOOK FOLDER --students 40`` makes the archives, the list of students and
what is put by hand into ``submitted`` from a notebook, so that a class can be collected by hand, too.
"""

from __future__ import annotations

import argparse
import sys
import unicodedata
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parent))
from downloads import BOMB, Link, write_zip, zipped

if TYPE_CHECKING:
    from collections.abc import Callable

FIRST = ("Ada", "José", "Zoë", "Bär", "Søren", "Łucja", "Chloé", "Nguyễn", "Eve", "Olu")
LAST = ("Lovelace", "Núñez", "O'Neill", "Müller", "Ørsted", "Kowalska", "Dupont", "Anh")
DUE = datetime(2026, 1, 10, 12)
"""In UTC, as all times here."""
BY_HAND = {
    "numbered beside": "",
    "numbered alone": "",
    "too high": "",
    "decomposed": "José",
    "small letters": "bob",
    "capitals": "Bob",
}
"""How work lies in ``submitted`` that somebody has put there, and the student's id where that is the oddity."""


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
    """

    place: int
    id: str
    first: str
    last: str
    lms: str
    late: bool
    habit: str = ""

    @property
    def hands_in(self) -> bool:
        """Whether there is any work."""
        return bool(self.lms or self.habit)

    @property
    def when(self) -> datetime:
        """When the work comes."""
        return DUE + timedelta(hours=30 if self.late else -self.place - 1)

    @property
    def times_are_known(self) -> bool:
        """Whether the system says when work came."""
        return self.lms in ("blackboard", "brightspace")


def pupils(count: int) -> list[Pupil]:
    """The class; the last one hands in nothing, those before by hand; two of those whose systems say when are late."""
    found = []
    habits = dict(enumerate(BY_HAND, count - 1 - len(BY_HAND)))
    for place in range(count):
        habit = habits.get(place, "")
        lms = "" if place >= min(habits) else ("moodle", "canvas", "blackboard", "brightspace")[place % 4]
        first, last = (
            FIRST[place % len(FIRST)],
            f"{LAST[place % len(LAST)]}{'' if place < 8 else ' ' + 'abcdefgh'[place // 8]}",
        )
        id_ = BY_HAND.get(habit) or f"s{place:02}"
        found.append(Pupil(place, id_, first, last, lms, place in (2, 3), habit))
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
        The archives.
    """
    archives: dict[str, dict[str, bytes | str]] = {
        "moodle": {},
        "canvas": {},
        "blackboard": {},
        "brightspace": {},
    }
    for pupil in class_:
        if pupil.lms:
            archives[pupil.lms] |= _FORMS[pupil.lms](pupil, work, assignment)
    if strange:
        _put_strange(archives, class_, work)
    return [write_zip(folder / f"{name}.zip", files) for name, files in archives.items()]


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
    lines = ["id,first_name,last_name,email,canvas"]
    lines += [f"{one.id},{one.first},{one.last},{one.id}@uni.example,{1000 + one.place}" for one in class_]
    return "\n".join(lines) + "\n"


def _moodle(pupil: Pupil, work: Callable[[Pupil, bool], str], assignment: str) -> dict[str, bytes | str]:
    name = f"{pupil.first} {pupil.last}_{500 + pupil.place}_assignsubmission_file"
    if pupil.place % 12 == 4:
        return {
            f"{name}_my work.zip": zipped({f"in/{assignment} (2).ipynb": work(pupil, False), "in/a.txt": "x"})
        }
    if pupil.place % 12 == 8:
        return {f"{name}/{assignment}.ipynb": work(pupil, False)}
    return {unicodedata.normalize("NFD", f"{name}_{assignment}.ipynb"): work(pupil, False)}


def _canvas(pupil: Pupil, work: Callable[[Pupil, bool], str], assignment: str) -> dict[str, bytes | str]:
    login = "".join(c for c in f"{pupil.last}{pupil.first}".lower() if c.isalnum())
    name = f"{login}_{1000 + pupil.place}_"
    files: dict[str, bytes | str] = {f"{name}{9000 + pupil.place}_{assignment}-1.ipynb": work(pupil, False)}
    if pupil.place % 8 == 1:
        files[f"{name}{8000 + pupil.place}_{assignment}.ipynb"] = work(pupil, True)
    return files


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


_FORMS = {"moodle": _moodle, "canvas": _canvas, "blackboard": _blackboard, "brightspace": _brightspace}


def main() -> None:
    """Make the work of a class in which everybody hands in the same notebook."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("notebook", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--students", type=int, default=40)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    class_ = pupils(given.students)
    text = given.notebook.read_text(encoding="utf-8")
    put_by_hand(given.folder / "submitted", class_, lambda *_: text)
    (given.folder / "students.csv").write_text(roster(class_), encoding="utf-8")
    for path in hand_in(given.folder, class_, lambda *_: text):
        sys.stdout.write(f"{path}\n")


if __name__ == "__main__":
    main()
