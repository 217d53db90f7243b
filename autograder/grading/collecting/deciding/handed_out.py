"""Distinguishes a student's work from a notebook that is still as it was handed out. A student may send both."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.errors import GradingError
from autograder.grading.rebuilding.desk import read_notebook
from autograder.grading.rebuilding.parsing import parse
from autograder.grading.rebuilding.rebuild import grade_id, is_answer
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from autograder.grading.classes.class_directory import ClassDirectory


class HandedOut:
    """Compares notebooks with the parts that the class itself provides.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory
        self._texts = functools.cache(self._read)

    def has_work(self, assignment: str, notebook: str, data: bytes) -> bool:
        """Return True if a file has an answer, or an added cell, that was not handed out.

        If the class's own notebook cannot be read, every notebook counts as containing work. An unreadable file
        contains none.
        """
        try:
            cells, _ = read_notebook(data)
        except UnreadableSubmission:
            return False
        given, theirs = self._texts(assignment, notebook)
        return not given or any(
            cell.source.strip() not in given for cell in cells if cell.grade_id not in theirs
        )

    def _read(self, assignment: str, notebook: str) -> tuple[set[str], set[str]]:
        """Return the texts of the class's own cells, and the names of the cells that students do not change."""
        try:
            cells = self._directory.master(assignment, notebook).cells
        except GradingError:
            return set(), set()
        given = {"", *(cell.source.strip() for cell in cells), *self._released(assignment, notebook)}
        return given, {grade_id(cell) for cell in cells if not is_answer(cell)} - {""}

    def _released(self, assignment: str, notebook: str) -> set[str]:
        """Return the texts of the cells in ``release``, which may be older than the source."""
        path = self._directory.path / "release" / assignment / f"{notebook}{SUFFIX}"
        try:
            return {cell.source.strip() for cell in parse(read_bytes(path))[0]}
        except UnreadableSubmission:
            return set()
