"""Compares all submissions of a class, and lists the similar pairs and the files that were not compared."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.grading.collecting.beside_its_place import beside_their_place
from autograder.grading.errors import GradingError, check_known
from autograder.grading.similarity.own_code import LONGEST, GivenTexts, compared
from autograder.grading.similarity.pairs import Pair, by_students, close_pairs, closest_first
from autograder.grading.similarity.student_texts import given_texts, read_answers
from autograder.grading.table.roster import read_roster

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory, RefusedFile

MOST = 100
"""The maximum number of pairs of students to show, the most similar first."""


@dataclass(frozen=True)
class Similar:
    """The result of a search for similar answers in a class.

    Attributes:
        path: The class.
        pairs: The similar pairs of answers, the most similar first.
        more: The number of pairs of students that are left out of ``pairs``.
        names: The students' names, by id.
        compared: The number of submitted notebooks that were compared.
        notes: Sentences for the instructor that are not about a failure.
        troubles: A line for each file that was not compared, or only in part.
    """

    path: Path
    pairs: tuple[Pair, ...]
    more: int
    names: Mapping[str, str]
    compared: int
    notes: tuple[str, ...]
    troubles: tuple[str, ...]

    @property
    def exit_code(self) -> int:
        """The command's exit code: 0 if every file was compared, even if there are similar pairs; otherwise 2."""
        return 2 if self.troubles else 0


def find_similar(directory: ClassDirectory, assignment: str = "") -> Similar:
    """Compare the submissions of a class with each other.

    Args:
        directory: The class.
        assignment: The assignment whose submissions are compared; all assignments if empty.

    Raises:
        GradingError: No submission exists, the assignment does not exist, or a source notebook cannot be used.
    """
    known = directory.assignments()
    check_known([assignment] if assignment else [], known, "assignment")
    submissions, refused = directory.submissions()
    submissions = [one for one in submissions if assignment in ("", one.assignment)]
    troubles = list(_not_looked_at(directory, refused, assignment))
    if not submissions and not troubles:
        raise GradingError(
            f"The class has no submissions yet{f' for {assignment}' if assignment else ''}, so nothing can be compared."
        )
    given = GivenTexts(given_texts(directory))
    pairs: list[Pair] = []
    notes = []
    read = 0
    for name in [assignment] if assignment else known:
        for notebook in directory.notebooks(name):
            handed_in = read_answers(
                directory, name, notebook, [one for one in submissions if one.assignment == name]
            )
            read += len(handed_in.students)
            troubles += handed_in.troubles
            if len(handed_in.students) == 1:
                notes.append(
                    f"{notebook}: only one student has submitted this notebook, so there is nothing to compare"
                )
            answers = compared(handed_in.answers, given, len(handed_in.students))
            troubles += [
                f"left out     {one.answer.student}/{name}: {one.answer.cell} is too long; only its "
                f"first {LONGEST} words were compared"
                for one in answers
                if one.is_cut
            ]
            pairs += close_pairs(answers)
    groups = by_students(closest_first(pairs))
    students = read_roster(directory).students
    return Similar(
        directory.path,
        tuple(itertools.chain.from_iterable(groups[:MOST])),
        len(groups[MOST:]),
        {id_: student.name for id_, student in students.items() if student.name},
        read,
        tuple(notes),
        tuple(troubles),
    )


def _not_looked_at(
    directory: ClassDirectory, refused: Iterable[RefusedFile], assignment: str
) -> Iterator[str]:
    """Yield a line for each file that cannot be used because it is refused or lies in a wrong folder."""
    for one in (*refused, *beside_their_place(directory)[0]):
        # A file above the assignment's folder may belong to any assignment.
        below = one.path.relative_to(directory.path / "submitted").parts[1:]
        if not assignment or not below or below[0] == assignment:
            yield f"refused      {one.path}: {one.reason}"
