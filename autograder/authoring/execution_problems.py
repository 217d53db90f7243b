"""Finds the problems of an executed notebook, and writes a page that shows the notebook with its problems."""

from __future__ import annotations

import html
import re  # noqa: TID251  (not what a student handed in)
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from nbconvert import HTMLExporter

from autograder.authoring.execution_plan import NotebookKind
from autograder.boxes.limits import Ended
from autograder.execution.cells import CellType
from autograder.grading.rebuilding import nbformat_nodes

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from nbformat import NotebookNode

    from autograder.authoring.execution_plan import Planned
    from autograder.execution.cells import Cell, CellRun, Execution
    from autograder.verdict import Verdict

TRACEBACK = "Traceback (most recent call last)"
_SHELL = re.compile(r"^\s*(%%|!)", re.MULTILINE)
"""Matches a cell that runs programs. Such a cell may write to standard error without any problem: colcon and ros2
do.
"""

_HOW_IT_ENDED = {
    Ended.TIMED_OUT: "was stopped at its time limit",
    Ended.KERNEL_DIED: "ended the kernel",
    Ended.OUT_OF_MEMORY: "used too much memory",
    Ended.OUT_OF_CPU: "used too much processor time",
    Ended.TOO_MANY_PROCESSES: "started too many processes",
    Ended.TOO_MUCH_OUTPUT: "printed too much",
    Ended.NOT_RUN: "was not run",
}


@dataclass(frozen=True)
class Problem:
    """A problem that was found in an executed notebook.

    Attributes:
        cell: The index of the cell; None if the problem concerns the whole notebook.
        text: What is wrong, in words.
    """

    cell: int | None
    text: str


def problems_of(planned: Planned, execution: Execution) -> list[Problem]:
    """Return all problems of a notebook, in the order of its cells; empty if there are none."""
    if execution.trouble:
        return [Problem(None, f"the grader had trouble: {execution.trouble}")]
    return [
        Problem(index, text)
        for index, (cell, run) in enumerate(zip(planned.task.cells, execution.cells, strict=True))
        for text in _of_cell(planned.kind, cell, run, execution.verdicts.get(index))
    ]


def _of_cell(kind: NotebookKind, cell: Cell, run: CellRun, verdict: Verdict | None) -> Iterator[str]:
    if run.ended is Ended.RAISED:
        yield f"raised {run.error}"
    elif run.ended is not Ended.DONE:
        yield _HOW_IT_ENDED[run.ended]
    elif any(TRACEBACK in _text(output) for output in run.outputs):
        yield "shows a stray traceback"
    if not _SHELL.search(cell.source) and any(output.get("name") == "stderr" for output in run.outputs):
        # nbgrader gives no points to a graded cell that writes to stderr, and students think that such output is an
        # error.
        yield "writes to standard error"
    if cell.check is not None and run.ended is Ended.DONE:
        yield from _of_check(kind, cell.check.points, run, verdict)


def _of_check(kind: NotebookKind, points: float, run: CellRun, verdict: Verdict | None) -> Iterator[str]:
    wanted = points if kind is NotebookKind.MASTER else 0.0
    if verdict is None:
        yield "has no verdict"
        return
    if verdict.score != wanted:
        yield f"earns {verdict.score:g} of {points:g} points instead of {wanted:g}{_why(verdict)}"
    values = [
        output["data"].get("text/plain")
        for output in run.outputs
        if output["output_type"] == "execute_result"
    ]
    if not values or not _is_number(values[-1], verdict.score):
        # The value of the cell must be the score, because unmodified nbgrader reads partial credit from this value.
        yield f"has the value {values[-1] if values else 'nothing'} instead of its score, {verdict.score:g}"


def _why(verdict: Verdict) -> str:
    reasons = [f"{c.title}: {c.seen}" for c in verdict.criteria if not c.passed]
    if verdict.diagnosis is not None:
        reasons.insert(0, f"{verdict.diagnosis.key}: {verdict.diagnosis.text}")
    return f" ({'; '.join(reasons)})" if reasons else ""


def _is_number(text: str, number: float) -> bool:
    try:
        return float(text) == number
    except (TypeError, ValueError):
        return False


def _text(output: dict[str, Any]) -> str:
    return str(output.get("text", "")) + str(output.get("data", {}).get("text/plain", ""))


def write_report(folder: Path, planned: Planned, execution: Execution, found: Sequence[Problem]) -> Path:
    """Write the page about the problems of a notebook.

    Args:
        folder: The folder for the page, which is created if it does not exist.
        planned: The notebook.
        execution: The result of the execution.
        found: The problems.

    Returns:
        The path of the page.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{planned.task.notebook}-{planned.kind}.html"
    # By default, nbconvert also searches the current folder for templates, which may run code.
    exporter = HTMLExporter(extra_template_basedirs=[])
    exporter.anchor_link_text = ""
    page, _ = exporter.from_notebook_node(
        _with_outputs(planned, execution, found),
        {"metadata": {"name": planned.label}, "config_dir": str(folder)},
    )
    path.write_text(page, encoding="utf-8")
    return path


def _with_outputs(planned: Planned, execution: Execution, found: Sequence[Problem]) -> NotebookNode:
    notebook = nbformat_nodes.copied(planned.notebook)
    cells = []
    for index, cell in enumerate(notebook.cells):
        if cell.cell_type == CellType.CODE and index < len(execution.cells):
            cell.outputs = [nbformat_nodes.output(**output) for output in execution.cells[index].outputs]
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
    return nbformat_nodes.cell(CellType.MARKDOWN, f'<div style="{style}">\n{text}\n</div>')
