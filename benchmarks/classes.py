"""A class of any size, made of the answers of the bank: the same students at every run."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder import course
from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory
from autograder.grading.new_classes.new_class import new_class
from tests.submissions.odd_notebooks import BANK, OddNotebook, text_of

if TYPE_CHECKING:
    from pathlib import Path

_ONE_WRONG_IN = 4
"""Every fourth student has one wrong answer."""


@dataclass(frozen=True)
class Variants:
    """Students' answers to one exercise.

    Attributes:
        right: Files of the bank that earn full marks; empty if there is only the master's own solution.
        wrong: Files that earn less, and come to an end by themselves.
    """

    right: tuple[str, ...]
    wrong: tuple[str, ...]


@dataclass(frozen=True)
class BenchmarkClass:
    """A class whose submissions are known.

    Attributes:
        path: The class directory.
        students: Their ids, in order.
        honest: Pairs of student and assignment whose answers are all right.
    """

    path: Path
    students: tuple[str, ...]
    honest: frozenset[tuple[str, str]]

    @property
    def assignments(self) -> list[str]:
        """The names of its assignments."""
        return ClassDirectory(self.path).assignments()


def make_class(path: Path, students: int, assignments: tuple[str, ...] = ()) -> BenchmarkClass:
    """Make a class in which every student hands in every notebook.

    Endless loops are left out: stock nbgrader would sit each of them out alone, which would flatter us.

    Args:
        path: The folder for the class.
        students: The number of students.
        assignments: Only these; all graded notebooks of the course by default.
    """
    new_class(path, course.root(), assignments=assignments)
    bank = bank_variants()
    names = tuple(f"student-{number:03}" for number in range(students))
    honest = set()
    for number, student in enumerate(names):
        for assignment in ClassDirectory(path).assignments():
            files = _answers(bank, assignment, number)
            if not any("/wrong/" in file for file in files):
                honest.add((student, assignment))
            wanted = OddNotebook(student, assignment, "", {}, bank=files)
            folder = path / "submitted" / student / assignment
            folder.mkdir(parents=True)
            (folder / f"{assignment}{SUFFIX}").write_text(text_of(path, wanted), encoding="utf-8")
    return BenchmarkClass(path, names, frozenset(honest))


def bank_variants() -> dict[str, Variants]:
    """The bank's answers for notebooks, by exercise."""
    data = tomllib.loads((course.root() / BANK / "notebooks.toml").read_text(encoding="utf-8"))
    return {
        exercise: Variants(
            right=tuple(f"{exercise}/right/{name}" for name in sorted(kinds.get("right", {}))),
            wrong=tuple(
                f"{exercise}/wrong/{name}"
                for name, entry in sorted(kinds.get("wrong", {}).items())
                if entry.get("ends") != "timeout"
            ),
        )
        for exercise, kinds in data.items()
    }


def _answers(bank: dict[str, Variants], assignment: str, number: int) -> tuple[str, ...]:
    """The files of the bank that student ``number`` hands in; the master's solution fills what they leave."""
    chosen = []
    for place, (exercise, variants) in enumerate(sorted(bank.items())):
        if exercise.partition(".")[0] != assignment:
            continue
        # One exercise of the bank is this student's weak one, another one for the next such student.
        weak = number % _ONE_WRONG_IN == _ONE_WRONG_IN - 1 and number // _ONE_WRONG_IN % len(bank) == place
        files = variants.wrong if weak else variants.right
        chosen.append(files[number % len(files)])
    return tuple(chosen)
