"""Which notebook of which assignment a file is: its name says so, or its cells do."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.collecting.forms import base_and_number
from autograder.grading.rebuilding.submission import UnreadableSubmission, parse

if TYPE_CHECKING:
    from autograder.grading.classes.class_directory import ClassDirectory

Target = tuple[str, str]
"""An assignment, and one of its notebooks."""


class Which:
    """Knows the notebooks of a class by their names and by their cells.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory

    def is_notebook(self, file: str) -> bool:
        """Whether a file of this name is a notebook of the class."""
        stem = base_and_number(file[: -len(SUFFIX)])[0] if file.lower().endswith(SUFFIX) else file
        return stem.casefold() in self._notebooks

    def told(self, stem: str, data: bytes) -> Target | None:
        """Which notebook of which assignment the name says that it is, or else the cells."""
        return self._notebooks.get(stem.casefold()) or self._by_its_cells(data)

    def _by_its_cells(self, data: bytes) -> Target | None:
        try:
            names = {cell.grade_id for cell in parse(data)[0] if cell.grade_id}
        except UnreadableSubmission:
            return None
        shared = {target: len(names & own) for target, own in self._grade_ids.items()}
        most = max(shared.values(), default=0)
        best = [target for target, count in shared.items() if count == most]
        return best[0] if most and len(best) == 1 else None

    @functools.cached_property
    def _notebooks(self) -> dict[str, Target]:
        """Assignment and notebook by the notebook's name."""
        return {
            notebook.casefold(): (assignment, notebook)
            for assignment in self._directory.assignments()
            for notebook in self._directory.notebooks(assignment)
        }

    @functools.cached_property
    def _grade_ids(self) -> dict[Target, set[str]]:
        """The names of the cells of each notebook, as they are handed out."""
        found = {}
        for assignment, notebook in self._notebooks.values():
            path = self._directory.path / "source" / assignment / f"{notebook}{SUFFIX}"
            found[assignment, notebook] = {cell.grade_id for cell in parse(path.read_bytes())[0]} - {""}
        return found
