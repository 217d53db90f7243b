"""From a source notebook to the chapter notebook, through the steps of ``nbgrader generate_assignment``.

The steps run in this process and without a gradebook, which takes milliseconds a notebook instead of seconds.
A test proves that nbgrader's own command gives the same bytes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nbconvert.exporters import NotebookExporter
from nbgrader.converters import GenerateAssignment
from nbgrader.preprocessors import ClearSolutions, NbGraderPreprocessor
from nbgrader.utils import is_solution
from traitlets.config import Config

from autograder.masters.code_cells import find_region
from autograder.masters.master_errors import CellError

if TYPE_CHECKING:
    from nbformat import NotebookNode


class LeaveStubs(ClearSolutions):
    """nbgrader's ClearSolutions, changed so that each solution leaves a stub of its own.

    Stock nbgrader puts the same text into every cleared region. Here each region opens with the comment that students
    get in its place (``code_cells.py``), so the cell runs as it is and says what is to be done. Any other solution is
    cleared as nbgrader does it.
    """

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


def release_preprocessors() -> list[type[NbGraderPreprocessor]]:
    """The steps of nbgrader for a release, with :class:`LeaveStubs` in the place of ClearSolutions.

    A class's ``nbgrader_config.py`` names them through :class:`autograder.masters.release_steps.ReleaseSteps`.
    """
    return [LeaveStubs if step is ClearSolutions else step for step in GenerateAssignment().preprocessors]


def release_text(source: NotebookNode) -> str:
    """The chapter notebook of ``source`` as it is written to a file."""
    config = Config()
    config.Exporter.default_preprocessors = []
    # As `nbgrader generate_assignment --no-db` does; the step only writes to the gradebook.
    config.SaveCells.enabled = False
    exporter = NotebookExporter(config=config)
    for step in release_preprocessors():
        exporter.register_preprocessor(step)
    text, _ = exporter.from_notebook_node(source)
    return text
