"""``autograder execute``: runs every notebook of the course, and reports each problem.

A master is expected to earn full marks, a student's notebook no points. A notebook with problems is written with its
outputs.
"""

from __future__ import annotations

import contextlib
import os
import re  # noqa: TID251  (not what a student handed in)
import time
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder import standard_output
from autograder.boxes.run_limits import Ended, Limits
from autograder.cards.readable_text import TRACEBACK
from autograder.command_name import COMMAND
from autograder.execution.executed_cells import CellType
from autograder.grading.grading_task import Task
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.running import execution_backends
from autograder.grading.running.batch_progress import BatchProgress, plain_line
from autograder.grading.tasks.task_making import cells_of
from autograder.masters.master_files import chapter_path, lab_name, masters
from autograder.masters.source_notebooks import source_notebook
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nbformat import NotebookNode
    from rich.console import Console

    from autograder.execution.executed_cells import Cell, CellRun, Execution
    from autograder.verdict import Verdict


REPORTS_FOLDER = "execution-reports"
"""The name of the folder, in the course's top folder, for failed notebooks with their outputs. Those of an earlier run
are removed.
"""


@dataclass(frozen=True)
class Executed:
    """A notebook that was executed.

    Attributes:
        planned: The notebook and its expected result.
        execution: The result of the execution.
        found: The problems that were found; empty if there are none.
        report: The path of the notebook with its outputs; None if there are no problems.
    """

    planned: Planned
    execution: Execution
    found: tuple[Problem, ...]
    report: Path | None


def execute_command(
    root: Path,
    *,
    only: Sequence[str] = (),
    jobs: int | None = None,
    console: Console | None = None,
) -> int:
    """Execute the notebooks of a course and print the problems of each.

    Args:
        root: The top folder of the course, which contains ``solutions`` and ``chapters``.
        only: Names such as ``"lab_1_2"``; all notebooks if empty.
        jobs: The number of notebooks to execute at the same time; by default as many as processors and memory allow.
        console: The console for progress and result; by default standard error.

    Returns:
        0 if nothing is wrong, 1 if a notebook failed.

    Raises:
        NothingToExecuteError: A name in ``only`` does not exist, or a chapter has not been built.
        autograder.masters.master_files.MasterError: A master cannot be used.
    """
    began = time.monotonic()
    console = console or standard_output.console(stderr=True)
    folder = root / REPORTS_FOLDER
    planned = execution_plan(root, only)
    _remove_reports(folder)
    results = execute_all(planned, folder, jobs=jobs, console=console)
    failed = [result for result in results if result.found]
    for result in failed:
        plain_line(console, f"{result.planned.label} failed, see {result.report}")
        for problem in result.found:
            where = "" if problem.cell is None else f"cell {problem.cell + 1} "
            plain_line(console, f"  {where}{problem.text}")
    seconds = time.monotonic() - began
    plain_line(console, f"{len(results)} notebooks executed, {len(failed)} failed, {seconds:.1f} s")
    return 1 if failed else 0


def execute_all(
    planned: Sequence[Planned],
    reports: Path,
    *,
    jobs: int | None = None,
    console: Console,
) -> list[Executed]:
    """Execute notebooks in parallel, each with its own kernel, folder and judge.

    Args:
        planned: The notebooks to execute.
        reports: The folder for failed notebooks.
        jobs: The number of notebooks to execute at the same time; by default as many as processors and memory allow.
        console: The console for progress.

    Returns:
        A result for each notebook, in the given order.
    """
    of_task = {id(item.task): item for item in planned}
    results: dict[int, Executed] = {}
    # The prefix is short, because Unix sockets are made in this folder, and their paths may not be long.
    with (
        HeldFolder("autograder-run-") as scratch,
        BatchProgress(console, len(planned), doing="executing", did="executed") as progress,
    ):
        running = execution_backends.execute_all(
            # Long notebooks start first. Otherwise one core could be busy long after the others.
            [one.task for one in sorted(planned, key=lambda one: -sum(map(_weight, one.task.cells)))],
            scratch.path,
            jobs,
            on_start=lambda task: progress.started(task.label),
            boxed=False,
            # What is sourced in this terminal: the course's own notebooks may use all that their author does.
            overlays=[Path(one) for one in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if one],
        )
        with contextlib.closing(running):
            for done in running:
                item = of_task[id(done.task)]
                found = tuple(problems_of(item, done.execution))
                report = _write_executed(reports, item, done.execution) if found else None
                results[id(done.task)] = Executed(item, done.execution, found, report)
                note = f" ({done.execution.seconds:.1f} s)"
                progress.finished(done.task.label, failed=bool(found), note=note)
    return [results[id(item.task)] for item in planned]


def _weight(cell: Cell) -> float:
    """Return an estimate of the seconds that a cell takes, by its kind: build, terminal, check or other code."""
    if cell.kind is not CellType.CODE:
        return 0.0
    if "colcon build" in cell.source:
        return 5.0
    return 1.0 if cell.check or cell.source.startswith("%%bash") else 0.1


def _remove_reports(folder: Path) -> None:
    for kind in NotebookKind:
        for report in folder.glob(f"*-{kind}.ipynb"):
            report.unlink()
    with contextlib.suppress(OSError):
        folder.rmdir()


class NotebookKind(StrEnum):
    """The kind of a notebook, which decides its expected result."""

    MASTER = "master"
    """The master, which contains the solutions, has to earn full marks."""
    CHAPTER = "chapter"
    """The notebook as students get it has to earn no points and raise no error."""


@dataclass(frozen=True)
class Planned:
    """A notebook that will be executed.

    Attributes:
        kind: Whether the notebook is a master, or as students get it.
        notebook: The notebook in format 4.5, without outputs.
        task: The same notebook as a task for execution.
    """

    kind: NotebookKind
    notebook: NotebookNode
    task: Task

    @property
    def label(self) -> str:
        """The name of the notebook in messages, such as ``"master lab_1_2"``."""
        return f"{self.kind} {self.task.notebook}"


class NothingToExecuteError(LookupError):
    """A notebook does not exist, was not built, or is damaged. The message says what to do."""


def execution_plan(root: Path, only: Sequence[str] = ()) -> list[Planned]:
    """Return two notebooks for each lab of a course: the master, and the one that students get.

    The second notebook is the file in ``chapters`` that students open. It is not built again.

    Args:
        root: The top folder of the course, which contains ``solutions`` and ``chapters``.
        only: Names such as ``"lab_1_2"``; all notebooks if empty.

    Raises:
        NothingToExecuteError: A name does not exist; or a file in ``chapters`` is missing or not a notebook.
        autograder.masters.master_files.MasterError: A master cannot be used.
    """
    found = masters(root)
    known = [lab_name(master) for master in found]
    for name in only:
        if name not in known:
            raise NothingToExecuteError(
                f"no notebook is named {name!r}. The notebooks are: {', '.join(known)}."
            )
    planned = []
    for master in found:
        if only and lab_name(master) not in only:
            continue
        chapter = chapter_path(root, master)
        if not chapter.is_file():
            raise NothingToExecuteError(f"{chapter.relative_to(root)} does not exist: run `{COMMAND} build`.")
        try:
            built = nbformat_nodes.read(chapter.read_text(encoding="utf-8"))
        except Exception as error:  # nbformat may raise any error of the libraries that it uses
            raise NothingToExecuteError(
                f"{chapter.relative_to(root)} is not a notebook: run `{COMMAND} build`."
            ) from error
        planned.append(_planned(NotebookKind.MASTER, lab_name(master), source_notebook(master)))
        planned.append(_planned(NotebookKind.CHAPTER, lab_name(master), built))
    return planned


_LIMITS = Limits(cell_seconds=180.0, notebook_seconds=900.0)
"""Time limits of a cell and a notebook, longer than for a submission: a cell may build a workspace, and several
notebooks share the machine.
"""


def _planned(kind: NotebookKind, name: str, notebook: NotebookNode) -> Planned:
    task = Task(
        student=kind,
        assignment="execute",
        notebook=name,
        cells=cells_of(notebook),
        seed=f"execute {name}",
        course="",
        limits=_LIMITS,
        # No sandbox is needed, because these are the course's own notebooks.
        boxed=False,
    )
    return Planned(kind, notebook, task)


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
        for text in _problems_of_cell(planned.kind, cell, run, execution.verdicts.get(index))
    ]


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


def _problems_of_cell(kind: NotebookKind, cell: Cell, run: CellRun, verdict: Verdict | None) -> Iterator[str]:
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
        yield from _problems_of_check(kind, cell.check.points, run, verdict)


def _problems_of_check(
    kind: NotebookKind, points: float, run: CellRun, verdict: Verdict | None
) -> Iterator[str]:
    wanted = points if kind is NotebookKind.MASTER else 0.0
    if verdict is None:
        yield "has no verdict"
        return
    if verdict.score != wanted:
        reasons = [f"{c.title}: {c.seen}" for c in verdict.criteria if not c.passed]
        if verdict.diagnosis is not None:
            reasons.insert(0, f"{verdict.diagnosis.key}: {verdict.diagnosis.text}")
        because = f" ({'; '.join(reasons)})" if reasons else ""
        yield f"earns {verdict.score:g} of {points:g} points instead of {wanted:g}{because}"
    values = [
        output["data"].get("text/plain")
        for output in run.outputs
        if output["output_type"] == "execute_result"
    ]
    if not values or not _is_number(values[-1], verdict.score):
        # The value of the cell must be the score, because unmodified nbgrader reads partial credit from this value.
        yield f"has the value {values[-1] if values else 'nothing'} instead of its score, {verdict.score:g}"


def _is_number(text: str, number: float) -> bool:
    try:
        return float(text) == number
    except (TypeError, ValueError):
        return False


def _text(output: dict[str, Any]) -> str:
    return str(output.get("text", "")) + str(output.get("data", {}).get("text/plain", ""))


def _write_executed(folder: Path, planned: Planned, execution: Execution) -> Path:
    """Write a notebook with the outputs of its cells into a folder. Return its path."""
    notebook = nbformat_nodes.copied(planned.notebook)
    for cell, run in zip(notebook.cells, execution.cells, strict=False):
        if cell.cell_type == CellType.CODE:
            cell.outputs = [nbformat_nodes.output(**output) for output in run.outputs]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{planned.task.notebook}-{planned.kind}.ipynb"
    path.write_text(nbformat_nodes.text(notebook), encoding="utf-8")
    return path
