"""Tells a notebook with a student's work from a notebook without any, because a student may send both."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.errors import GradingError
from autograder.grading.rebuilding.desk import read_notebook
from autograder.grading.rebuilding.parsing import parse
from autograder.grading.rebuilding.rebuild import grade_id, is_answer
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from autograder.grading.classes.class_directory import ClassDirectory


def has_work(directory: ClassDirectory, assignment: str, notebook: str, data: bytes) -> bool:
    """Return True if a notebook has an answer, or an added cell, that was not handed out.

    The student's notebook is compared with those in ``release`` and in ``source``, because ``release`` may be older. If
    one of these two cannot be read, every notebook counts as containing work. But if the student's notebook cannot be
    read, it counts as containing none.

    Args:
        directory: The class.
        assignment: The name of the assignment.
        notebook: The name of the notebook.
        data: The bytes that a student handed in.
    """
    try:
        cells, _ = read_notebook(data)
    except UnreadableSubmission:
        return False
    try:
        source = directory.master(assignment, notebook).cells
        released, _ = parse(read_bytes(directory.path / "release" / assignment / f"{notebook}{SUFFIX}"))
    except (GradingError, UnreadableSubmission):
        return True
    given = {"", *(cell.source.strip() for cell in (*source, *released))}
    unchanged = {grade_id(cell) for cell in source if not is_answer(cell)} - {""}
    return any(cell.source.strip() not in given for cell in cells if cell.grade_id not in unchanged)
