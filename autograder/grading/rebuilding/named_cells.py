"""Finds out which notebook of a class a submitted one is: by the names of its cells, whatever the file is called."""

from __future__ import annotations

import functools
from collections import Counter
from typing import TYPE_CHECKING

from autograder.grading.rebuilding.notebook_parsing import parse
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable
    from pathlib import Path

    from autograder.grading.rebuilding.submitted_notebook import SubmittedCell


Target = tuple[str, str]
"""An assignment and one of its notebooks."""


class NamedCells:
    """The names of the cells in each source notebook of a class. The notebooks are read at the first use.

    Args:
        sources: The source file of each notebook.
    """

    def __init__(self, sources: dict[Target, Path]) -> None:
        self._paths = sources
        self.notes: list[str] = []
        """A sentence about each source notebook that cannot be read."""

    def closest(self, names: Collection[str], assignment: str = "") -> list[Target]:
        """Return the notebooks with the most of the given cell names; none if no notebook has any of the names.

        Args:
            assignment: The assignment whose notebooks are searched; all assignments if empty.
        """
        shared = {
            target: len({cell.grade_id for cell in cells if cell.grade_id} & set(names))
            for target, cells in self._sources.items()
            if assignment in ("", target[0])
        }
        most = max(shared.values(), default=0)
        return [target for target, count in shared.items() if most and count == most]

    def assignments(self, cells: Iterable[SubmittedCell]) -> list[str]:
        """Return the assignments whose graded cells are among the given cells, recognized by their names or ids."""
        marks = {mark for cell in cells for mark in _marks(cell)}
        return sorted({self._graded[mark] for mark in marks & self._graded.keys()})

    @functools.cached_property
    def _graded(self) -> dict[str, str]:
        """Return the assignment for each name and id of a graded cell that only one assignment uses."""
        cells = [(assignment, cell) for (assignment, _), own in self._sources.items() for cell in own]
        often = Counter(
            mark for mark, _ in {(mark, assignment) for assignment, cell in cells for mark in _marks(cell)}
        )
        return {
            mark: assignment
            for assignment, cell in cells
            if cell.is_graded
            for mark in _marks(cell)
            if often[mark] == 1
        }

    @functools.cached_property
    def _sources(self) -> dict[Target, list[SubmittedCell]]:
        """Return the cells of each source notebook; no cells for a notebook that cannot be read."""
        cells: dict[Target, list[SubmittedCell]] = {}
        for target, path in self._paths.items():
            try:
                cells[target], _ = parse(path.read_bytes())
            except (OSError, UnreadableSubmission) as error:
                cells[target] = []
                self.notes.append(
                    f"{path} cannot be read ({error}): submissions of this notebook are recognized only by "
                    "their file names"
                )
        return cells


def _marks(cell: SubmittedCell) -> set[str]:
    """Return the strings by which a cell is recognized: ``"name …"`` with its nbgrader name, ``"id …"`` with its id."""
    return {f"{kind} {mark}" for kind, mark in (("name", cell.grade_id), ("id", cell.identifier)) if mark}
