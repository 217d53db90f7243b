"""Turns a source notebook into the chapter notebook, with the steps of ``nbgrader generate_assignment``.

The steps run in this process and without a gradebook, which takes milliseconds per notebook instead of seconds. A test
proves that nbgrader's own command gives the same bytes.

This module imports no reader of masters, because grading uses it, too, and would load Jupytext for nothing.
"""

from __future__ import annotations

from typing import Any
from urllib.parse import quote

from nbconvert.exporters import NotebookExporter
from nbformat import NotebookNode
from nbgrader.converters import GenerateAssignment
from nbgrader.preprocessors import ClearSolutions, NbGraderPreprocessor
from nbgrader.utils import is_solution
from traitlets.config import Config

from autograder.masters.code_cells import find_region
from autograder.masters.master_files import CellError


class _LeaveStubs(ClearSolutions):
    """nbgrader's ClearSolutions, changed so that each removed solution leaves its own stub.

    Stock nbgrader replaces every solution by the same text. Here each region begins with the comment that
    students get instead (:func:`find_region`), so the cell can run and says what to do. A solution of any other form is
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
                # Clear the solution as nbgrader does: this is an instructor's own notebook, written for stock nbgrader.
                pass
            else:
                return cell, resources
        return super().preprocess_cell(cell, resources, cell_index)


class _KeepShownPictures(NbGraderPreprocessor):
    """Removes attached pictures that the released text does not show, because they belong to a solution."""

    def preprocess_cell(
        self,
        cell: NotebookNode,
        resources: dict[str, Any],
        cell_index: int,  # noqa: ARG002  (nbconvert's signature)
    ) -> tuple[NotebookNode, dict[str, Any]]:
        """Keep the pictures that one cell shows."""
        if "attachments" in cell:
            cell.attachments = shown_attachments(cell.source, cell.attachments)
            if not cell.attachments:
                del cell["attachments"]
        return cell, resources


def shown_attachments(source: str, attachments: NotebookNode) -> NotebookNode:
    """Return those attachments that a text shows."""
    return NotebookNode(
        {
            name: picture
            for name, picture in attachments.items()
            if f"attachment:{name}" in source or f"attachment:{quote(name)}" in source
        }
    )


def release_preprocessors() -> list[type[NbGraderPreprocessor]]:
    """Return the steps of nbgrader's ``generate_assignment``, adapted to this course.

    :class:`_LeaveStubs` replaces ClearSolutions, and :class:`_KeepShownPictures` is added. A class's
    ``nbgrader_config.py`` gets the steps through :class:`autograder.masters.release_steps.ReleaseSteps`.
    """
    steps = [_LeaveStubs if step is ClearSolutions else step for step in GenerateAssignment().preprocessors]
    return [*steps, _KeepShownPictures]


def release_text(source: NotebookNode) -> str:
    """Return the text of the chapter notebook's file, made from ``source``."""
    config = Config()
    config.Exporter.default_preprocessors = []
    # Leave out the step SaveCells, which only writes to the gradebook. `nbgrader generate_assignment --no-db` does so,
    # too.
    config.SaveCells.enabled = False
    exporter = NotebookExporter(config=config)
    for step in release_preprocessors():
        exporter.register_preprocessor(step)
    text, _ = exporter.from_notebook_node(source)
    return text
