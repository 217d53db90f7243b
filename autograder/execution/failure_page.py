"""The page that is kept of a notebook that failed: all cells with their output, the failing ones on top."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from nbconvert import HTMLExporter

from autograder.boxes.execution import CellType
from autograder.grading.rebuilding import nodes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from nbformat import NotebookNode

    from autograder.boxes.execution import Execution
    from autograder.execution.plan import Planned
    from autograder.execution.problems import Problem


def write_report(folder: Path, planned: Planned, execution: Execution, found: Sequence[Problem]) -> Path:
    """Write the page.

    Args:
        folder: Made where it is not there.
        planned: The notebook.
        execution: What came of it.
        found: What is wrong with it.

    Returns:
        The page's path.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{planned.task.notebook}-{planned.kind}.html"
    exporter = HTMLExporter()
    exporter.anchor_link_text = ""
    page, _ = exporter.from_notebook_node(
        _with_outputs(planned, execution, found), {"metadata": {"name": planned.label}}
    )
    path.write_text(page, encoding="utf-8")
    return path


def _with_outputs(planned: Planned, execution: Execution, found: Sequence[Problem]) -> NotebookNode:
    notebook = nodes.copied(planned.notebook)
    cells = []
    for index, cell in enumerate(notebook.cells):
        if cell.cell_type == CellType.CODE and index < len(execution.cells):
            cell.outputs = [nodes.output(**output) for output in execution.cells[index].outputs]
            cell.execution_count = None
        wrong = [problem.text for problem in found if problem.cell == index]
        if wrong:
            cells.append(_box(f'<p id="problem-{index}"><b>The next cell {_join(wrong)}.</b></p>'))
        cells.append(cell)
    notebook.cells = [_box(_summary(planned, found)), *cells]
    return notebook


def _summary(planned: Planned, found: Sequence[Problem]) -> str:
    lines = "".join(f"<li>{_line(problem)}</li>" for problem in found)
    return f"<p><b>{html.escape(planned.label)}</b> failed:</p><ul>{lines}</ul>"


def _line(problem: Problem) -> str:
    text = html.escape(problem.text)
    if problem.cell is None:
        return text
    return f'<a href="#problem-{problem.cell}">cell {problem.cell + 1}</a> {text}'


def _join(texts: Sequence[str]) -> str:
    return " and ".join(html.escape(text) for text in texts)


def _box(text: str) -> NotebookNode:
    style = "border-left: 6px solid #c62828; padding: 0.5em 1em; background: #fdecea; color: #5f1414"
    return nodes.cell(CellType.MARKDOWN, f'<div style="{style}">\n{text}\n</div>')
