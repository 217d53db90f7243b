"""nbgrader's ClearSolutions, changed so that each solution leaves a stub of its own.

Stock nbgrader puts the same text into every cleared region. Here each region opens with the comment that
students get in its place (``regions.py``), so the cell runs as it stands and says what is to be done.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nbgrader.preprocessors import ClearSolutions
from nbgrader.utils import is_solution

from autograder.masters.errors import CellError
from autograder.masters.regions import find_region

if TYPE_CHECKING:
    from nbformat import NotebookNode


class LeaveStubs(ClearSolutions):
    """Clears solution regions down to their TODO comment; clears any other solution as nbgrader does."""

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict[str, Any], cell_index: int
    ) -> tuple[NotebookNode, dict[str, Any]]:
        """Clear one cell."""
        if is_solution(cell) and cell.cell_type == "code":
            try:
                cell.source = find_region(cell.source).unsolved
            except CellError:
                # An instructor's own notebook, written for stock nbgrader.
                pass
            else:
                return cell, resources
        return super().preprocess_cell(cell, resources, cell_index)
