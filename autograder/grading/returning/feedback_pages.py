"""Makes the feedback pages for students. Templates are read only once for all pages."""

from __future__ import annotations

import functools
from html import escape
from typing import TYPE_CHECKING, Any

from nbgrader.utils import is_grade, is_solution, is_task

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.classes.gradebook_reading import read_entry
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.notebook_rebuilding import grade_id, is_check
from autograder.grading.returning.page_exporter import WAITS, PageExporter
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from nbformat import NotebookNode

    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.classes.gradebook_reading import CellEntry, SubmissionEntry


class FeedbackPages:
    """Makes the feedback pages of one class.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory

    def write(self, submission: Submission, notebooks: Sequence[str]) -> None:
        """Make the page of each notebook of a graded submission.

        Args:
            submission: A submission that is in ``autograded/`` and in the gradebook.
            notebooks: The names of its notebooks.

        Raises:
            OSError: A page could not be written.
        """
        entry = read_entry(self._directory.gradebook_url, *submission.key)
        graded, folder = (self._directory.folder(step, submission) for step in ("autograded", "feedback"))
        for name in notebooks:
            page = self._page(graded / f"{name}{SUFFIX}", submission, entry)
            write_whole(folder / f"{name}.html", page.encode())

    def _page(self, path: Path, submission: Submission, entry: SubmissionEntry) -> str:
        notebook, cells = nbformat_nodes.read_own(path.read_bytes()), entry.cells.get(path.stem, {})
        for cell in notebook.cells:
            _fill_in(cell, cells)
        penalty = entry.penalties.get(path.stem, 0.0)
        names = {
            "student": submission.student,
            "name": entry.name,
            "assignment": submission.assignment,
            "notebook": escape(self._directory.title(submission.assignment, path.stem)),
            "score": sum(cell.score for cell in cells.values()) - penalty,
            "max_score": sum(cell.max_score for cell in cells.values()),
            "late_penalty": penalty,
            "why_late": entry.why_late(self._directory.time_zone),
        }
        mark_waiting(notebook, cells)
        return self._exporter.page(notebook, names)

    @functools.cached_property
    def _exporter(self) -> PageExporter:
        return PageExporter(config=self._directory.config)


_FOR_A_PERSON, _TRIED_AGAIN = "waits for your instructor", "could not be checked, and is tried again"


def mark_waiting(notebook: NotebookNode, cells: Mapping[str, CellEntry]) -> None:
    """Mark the cells whose points a person or the judge still has to give.

    Args:
        notebook: A graded notebook. It is changed.
        cells: The notebook's entries in the gradebook, by grade_id.
    """
    for cell in notebook.cells:
        entry = cells.get(grade_id(cell))
        if entry is not None and entry.waits:
            unchecked = is_check(cell) and entry.by_hand is None
            cell.metadata.nbgrader[WAITS] = _TRIED_AGAIN if unchecked else _FOR_A_PERSON


def _fill_in(cell: Any, cells: Mapping[str, CellEntry]) -> None:
    """Add the points and the comment to a cell's metadata for the template, as nbgrader's GetGrades does."""
    marks: Mapping[str, Any] = cell.metadata.get("nbgrader", {})
    known = cells.get(marks.get("grade_id", ""))
    if known is None:
        return
    if is_solution(cell) or is_task(cell):
        cell.metadata.nbgrader["comment"] = known.comment
    if is_grade(cell) or is_task(cell):
        cell.metadata.nbgrader["score"] = known.score
        cell.metadata.nbgrader["points"] = known.max_score
