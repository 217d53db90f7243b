"""A class that hands in through four learning management systems, with every oddity that real downloads have.

``python tests/grading/day/handed_in.py NOTEBOOK FOLDER --students 40`` makes the archives and the list of students
from a notebook, so that a class can be collected by hand, too.
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
from downloads import write_zip, zipped

if TYPE_CHECKING:
    from collections.abc import Callable

FIRST = ("Ada", "José", "Zoë", "Bär", "Søren", "Łucja", "Chloé", "Nguyễn", "Eve", "Olu")
LAST = ("Lovelace", "Núñez", "O'Neill", "Müller", "Ørsted", "Kowalska", "Dupont", "Anh")
DUE = datetime(2026, 1, 10, 12)
"""In UTC, as all times here."""


@dataclass(frozen=True)
class Pupil:
    """A student of the made class.

    Attributes:
        place: Counted from 0; everything else follows from it.
        id: The student's id.
        first: First name.
        last: Last name.
        lms: Through which system the work comes; empty for who hands in nothing.
        late: Whether it comes after it was due.
    """

    place: int
    id: str
    first: str
    last: str
    lms: str
    late: bool

    @property
    def when(self) -> datetime:
        """When the work comes."""
        return DUE + timedelta(hours=30 if self.late else -self.place - 1)

    @property
    def times_are_known(self) -> bool:
        """Whether the system says when work came."""
        return self.lms in ("blackboard", "brightspace")


def pupils(count: int) -> list[Pupil]:
    """The class; the last one hands in nothing, two of those whose systems say when are late."""
    found = []
    for place in range(count):
        lms = "" if place == count - 1 else ("moodle", "canvas", "blackboard", "brightspace")[place % 4]
        first, last = (
            FIRST[place % len(FIRST)],
            f"{LAST[place % len(LAST)]}{'' if place < 8 else ' ' + 'abcdefgh'[place // 8]}",
        )
        found.append(Pupil(place, f"s{place:02}", first, last, lms, place in (2, 3)))
    return found


def hand_in(folder: Path, class_: list[Pupil], work: Callable[[Pupil, bool], str]) -> list[Path]:
    """Write what an instructor downloads.

    Args:
        folder: Where to.
        class_: Who hands in.
        work: A student's notebook; of an earlier attempt where the flag is set.

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
            archives[pupil.lms] |= _FORMS[pupil.lms](pupil, work)
    archives["moodle"]["Guest User_999_assignsubmission_file_lab_1_2.ipynb"] = work(class_[0], False)
    archives["canvas"]["../../evil_1_2_lab_1_2.ipynb"] = "out"
    return [write_zip(folder / f"{name}.zip", files) for name, files in archives.items()]


def roster(class_: list[Pupil]) -> str:
    """The list of students."""
    lines = ["id,first_name,last_name,email,canvas"]
    lines += [f"{one.id},{one.first},{one.last},{one.id}@uni.example,{1000 + one.place}" for one in class_]
    return "\n".join(lines) + "\n"


def _moodle(pupil: Pupil, work: Callable[[Pupil, bool], str]) -> dict[str, bytes | str]:
    name = f"{pupil.first} {pupil.last}_{500 + pupil.place}_assignsubmission_file"
    if pupil.place % 12 == 4:
        return {f"{name}_my work.zip": zipped({"in/lab_1_2 (2).ipynb": work(pupil, False), "in/a.txt": "x"})}
    if pupil.place % 12 == 8:
        return {f"{name}/lab_1_2.ipynb": work(pupil, False)}
    return {unicodedata.normalize("NFD", f"{name}_lab_1_2.ipynb"): work(pupil, False)}


def _canvas(pupil: Pupil, work: Callable[[Pupil, bool], str]) -> dict[str, bytes | str]:
    login = "".join(c for c in f"{pupil.last}{pupil.first}".lower() if c.isalnum())
    name = f"{login}_{1000 + pupil.place}_"
    files: dict[str, bytes | str] = {f"{name}{9000 + pupil.place}_lab_1_2-1.ipynb": work(pupil, False)}
    if pupil.place % 8 == 1:
        files[f"{name}{8000 + pupil.place}_lab_1_2.ipynb"] = work(pupil, True)
    return files


def _blackboard(pupil: Pupil, work: Callable[[Pupil, bool], str]) -> dict[str, bytes | str]:
    def name(when: datetime) -> str:
        return f"Lab 1.2_{pupil.id}_attempt_{when:%Y-%m-%d-%H-%M-%S}"

    before = pupil.when - timedelta(days=1)
    return {
        f"{name(pupil.when)}_lab_1_2.ipynb": work(pupil, False),
        f"{name(pupil.when)}.txt": "Name: somebody",
        f"{name(before)}_lab_1_2.ipynb": work(pupil, True),
    }


def _brightspace(pupil: Pupil, work: Callable[[Pupil, bool], str]) -> dict[str, bytes | str]:
    clock = f"{pupil.when:%I%M %p}".lstrip("0")
    when = f"{pupil.when:%b} {pupil.when.day}, {pupil.when:%Y} {clock}"
    folder = f"{700 + pupil.place}-42 - {pupil.first} {pupil.last} - {when}"
    return {f"{folder}/lab_1_2 (1).ipynb": work(pupil, False), "index.html": "<html>"}


_FORMS = {"moodle": _moodle, "canvas": _canvas, "blackboard": _blackboard, "brightspace": _brightspace}


def main() -> None:
    """Make the downloads of a class in which everybody hands in the same notebook."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("notebook", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--students", type=int, default=40)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    class_ = pupils(given.students)
    text = given.notebook.read_text(encoding="utf-8")
    (given.folder / "students.csv").write_text(roster(class_), encoding="utf-8")
    for path in hand_in(given.folder, class_, lambda *_: text):
        sys.stdout.write(f"{path}\n")


if __name__ == "__main__":
    main()
