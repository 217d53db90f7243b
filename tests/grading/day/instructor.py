"""What an instructor does with a class besides typing commands: due dates, penalties, questions, points by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import nbformat
from nbgrader.api import Gradebook

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.new_classes.new_class import release

if TYPE_CHECKING:
    from datetime import datetime

    from tiny_class import TinyClass


def book(tiny: TinyClass) -> Gradebook:
    return Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}")


def by_person(
    tiny: TinyClass, student: str, cell: str, points: float | None = None, extra: float = 0
) -> None:
    """What formgrader enters when somebody types points."""
    with book(tiny) as gradebook:
        grade = gradebook.find_grade(cell, "lab_1_2", "lab_1_2", student)
        grade.manual_score, grade.extra_credit, grade.needs_manual_grade = points, extra, False
        gradebook.db.commit()


def due(tiny: TinyClass, at: datetime | None) -> None:
    with book(tiny) as gradebook:
        gradebook.find_assignment("lab_1_2").duedate = at
        gradebook.db.commit()


def penalty(tiny: TinyClass) -> None:
    tiny.configure("c.LateSubmissionPlugin.penalty_method = 'zero'")


def add_question(tiny: TinyClass) -> None:
    """A question of five points that only a person can grade."""
    source = tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    notebook = nbformat.read(source, as_version=4)
    marks = {"grade": True, "solution": True, "locked": False, "schema_version": 3, "task": False}
    question = nbformat.v4.new_markdown_cell("Why?")
    question.metadata["nbgrader"] = {**marks, "grade_id": "why", "points": 5}
    notebook.cells.append(question)
    nbformat.write(notebook, source)
    release(ClassDirectory(tiny.path))
