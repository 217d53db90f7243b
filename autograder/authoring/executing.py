"""``autograder execute``: runs every notebook of the course, and reports each problem."""

from __future__ import annotations

import contextlib
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich.console import Console

from autograder.authoring.execution_plan import Planned, plan
from autograder.authoring.execution_problems import Problem, problems_of, write_report
from autograder.execution.cells import CellType
from autograder.grading.running import engine
from autograder.grading.running.progress import BatchProgress, plain_line
from autograder.temporary_folders import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.execution.cells import Cell, Execution

REPORTS = "execution-reports"
"""The name of the folder, in the course's top folder, for pages about failed notebooks."""


@dataclass(frozen=True)
class Executed:
    """A notebook that was executed.

    Attributes:
        planned: The notebook and its expected result.
        execution: The result of the execution.
        found: The problems that were found; empty if there are none.
        report: The path of the page about the problems; None if there are none.
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
    reports: Path | None = None,
    console: Console | None = None,
) -> int:
    """Execute the notebooks of a course and print the problems of each.

    Args:
        root: The top folder of the course, which contains ``solutions`` and ``chapters``.
        only: Names such as ``"lab_1_2"``; all notebooks if empty.
        jobs: The number of notebooks to execute at the same time; by default as many as processors and memory allow.
        reports: The folder for pages about failed notebooks. Pages from an earlier run are removed.
        console: The console for progress and result; by default standard error.

    Returns:
        0 if nothing is wrong, 1 if a notebook failed.

    Raises:
        NothingToExecuteError: A name in ``only`` does not exist, or a chapter has not been built.
        autograder.masters.master_errors.MasterError: A master cannot be used.
    """
    began = time.monotonic()
    console = console or Console(stderr=True)
    folder = reports or root / REPORTS
    planned = plan(root, only)
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
        reports: The folder for pages about failed notebooks.
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
        running = engine.execute_all(
            [item.task for item in _longest_first(planned)],
            scratch.path,
            jobs,
            on_start=lambda task: progress.started(task.label),
            boxed=False,
        )
        with contextlib.closing(running):
            for done in running:
                item = of_task[id(done.task)]
                found = tuple(problems_of(item, done.execution))
                page = write_report(reports, item, done.execution, found) if found else None
                results[id(done.task)] = Executed(item, done.execution, found, page)
                note = f" ({done.execution.seconds:.1f} s)"
                progress.finished(done.task.label, failed=bool(found), note=note)
    return [results[id(item.task)] for item in planned]


def _longest_first(planned: Sequence[Planned]) -> list[Planned]:
    """Sort notebooks so that long ones start first. Otherwise one core could be busy long after the others."""
    return sorted(planned, key=lambda item: -sum(_weight(cell) for cell in item.task.cells))


def _weight(cell: Cell) -> float:
    """Return an estimate of the seconds that a cell takes, by its kind: build, terminal, check or other code."""
    if cell.kind is not CellType.CODE:
        return 0.0
    if "colcon build" in cell.source:
        return 5.0
    return 1.0 if cell.check or cell.source.startswith("%%bash") else 0.1


def _remove_reports(folder: Path) -> None:
    for page in folder.glob("*.html"):
        page.unlink()
    with contextlib.suppress(OSError):
        folder.rmdir()
