"""Grading a class again in which nothing has changed."""

from __future__ import annotations

import contextlib
import io
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING
from unittest import mock

from rich.console import Console

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import CellRun, Execution
from autograder.grading import batch
from autograder.grading.running import execution_backends
from autograder.grading.running.task_dispatcher import Done
from autograder.verdict import State, Verdict
from benchmarks.ours import GRADE
from course_runtime.python_child import python_child

_MORE_TURNS = 2
"""If the course is edited meanwhile, the class is graded once more and is unchanged again after that."""

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

    from autograder.grading.grading_task import Task
    from benchmarks.classes import BenchmarkClass


def measure_regrade(made: BenchmarkClass, turns: int) -> list[tuple[float, float]]:
    """Wall and CPU seconds of ``autograder grade`` on a graded class, the start of the command included.

    How it was graded does not matter here: every check is taken to be passed, and no notebook is run for it.

    Args:
        made: The class.
        turns: How often.

    Raises:
        RuntimeError: Something was executed or written after all.
    """
    # In a process of its own: this one has read the course's code a while ago, and would know an older one.
    subprocess.run(python_child("-m", "benchmarks.regrade", str(made.path)).command, check=True)
    spent: list[tuple[float, float]] = []
    said = ""
    for _ in range(turns + _MORE_TURNS):
        began, cpu = time.monotonic(), _cpu()
        done = subprocess.run([*GRADE, str(made.path)], capture_output=True, text=True, check=False)
        said = f"{done.stdout[-400:]}{done.stderr[-400:]}"
        if "0 notebooks run" in done.stdout and "0 submissions entered" in done.stdout:
            spent.append((time.monotonic() - began, _cpu() - cpu))
        if len(spent) == turns:
            return spent
    raise RuntimeError(f"the class was not unchanged: {said}")


def _cpu() -> float:
    """CPU seconds of all commands that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _fill(path: Path) -> None:
    with mock.patch.object(execution_backends, "on_this_machine", _nobody):
        batch.grade(path, console=Console(file=io.StringIO()))


@contextlib.contextmanager
def _nobody(*_: object) -> Iterator[execution_backends.Execute]:
    def execute(tasks: Iterable[Task], on_start: Callable[[Task], None]) -> Generator[Done, None, None]:
        for task in tasks:
            on_start(task)
            yield Done(task, _passed(task))

    yield execute


def _passed(task: Task) -> Execution:
    verdicts = {
        index: Verdict(
            exercise=cell.check.exercise,
            title=cell.check.title,
            state=State.PASSED,
            score=cell.check.points,
            max_score=cell.check.points,
        )
        for index, cell in enumerate(task.cells)
        if cell.check
    }
    return Execution(tuple(CellRun(Ended.DONE) for _ in task.cells), verdicts)


if __name__ == "__main__":
    _fill(Path(sys.argv[1]))
