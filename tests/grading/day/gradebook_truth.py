"""What nbgrader's own gradebook says, read with nothing but nbgrader: all other numbers have to be these."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from nbgrader.api import Gradebook

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True)
class TrueCell:
    """A cell of one student's with points.

    Attributes:
        score: Points that count.
        judged: Without a person's.
        by_hand: A person's in their place; None where there are none.
        extra: On top.
        waits: Whether a person has to look at it.
    """

    score: float
    judged: float | None
    by_hand: float | None
    extra: float | None
    waits: bool


@dataclass(frozen=True)
class Truth:
    """A gradebook.

    Attributes:
        students: All ids.
        most: Points that can be had, by assignment and cell.
        cells: What was earned, by student, assignment and cell.
        late: What being late costs, by student and assignment, where it costs anything.
    """

    students: tuple[str, ...]
    most: dict[str, dict[str, float]]
    cells: dict[tuple[str, str, str], TrueCell]
    late: dict[tuple[str, str], float]

    def score(self, student: str, assignment: str) -> float:
        """Points in an assignment, less what being late costs."""
        earned = sum(cell.score for key, cell in self.cells.items() if key[:2] == (student, assignment))
        return max(0.0, earned - self.late.get((student, assignment), 0.0))

    def shown(self, student: str, assignment: str = "") -> float | None:
        """The same as tables and exports have it: None of who has handed in nothing, which is not zero."""
        names = [assignment] if assignment else list(self.most)
        there = [name for name in names if any(key[:2] == (student, name) for key in self.cells)]
        return sum(self.score(student, name) for name in there) if there else None

    def shown_of(self, assignment: str) -> dict[str, float | None]:
        """What tables and exports have of everybody."""
        return {student: self.shown(student, assignment) for student in self.students}

    def total(self, student: str) -> float:
        """Points in all assignments."""
        return sum(self.score(student, assignment) for assignment in self.most)

    @property
    def totals(self) -> dict[str, float]:
        """The total of everybody."""
        return {student: self.total(student) for student in self.students}

    def of(self, assignment: str) -> dict[str, float]:
        """Everybody's points in an assignment."""
        return {student: self.score(student, assignment) for student in self.students}


def read_truth(path: Path) -> Truth:
    """Read the gradebook of a class. A cell that the judge knows goes by the exercise's name, with a dot."""
    most: dict[str, dict[str, float]] = {}
    cells, late = {}, {}
    with Gradebook(f"sqlite:///{path / 'gradebook.db'}") as book:
        for one in book.assignments:
            assignment: Any = one
            graded = [cell for notebook in assignment.notebooks for cell in notebook.grade_cells]
            most[assignment.name] = {_exercise(cell.name): cell.max_score for cell in graded}
            for submission in book.assignment_submissions(assignment.name):
                key = submission.student.id, assignment.name
                if submission.late_submission_penalty:
                    late[key] = min(submission.late_submission_penalty, submission.score)
                for grade in (grade for notebook in submission.notebooks for grade in notebook.grades):
                    waits = bool(grade.needs_manual_grade)
                    cells[*key, _exercise(grade.name)] = TrueCell(
                        grade.score, grade.auto_score, grade.manual_score, grade.extra_credit, waits
                    )
        students = tuple(student.id for student in book.students)
    return Truth(students, most, cells, late)


def _exercise(cell: str) -> str:
    return cell.replace("lab_1_2-", "lab_1_2.")
