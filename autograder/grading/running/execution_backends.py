"""Executes tasks on this machine, as many at the same time as the memory allows, in a sandbox unless switched off.

Without a sandbox, nothing is graded unless the user explicitly asked for that.
"""

from __future__ import annotations

import contextlib
import functools
import os
from typing import TYPE_CHECKING

import psutil

from autograder.boxes.run_limits import BUILD_LIMITS, Limits
from autograder.grading.grading_errors import GradingError
from autograder.grading.running.process_link import ProcessLink
from autograder.grading.running.task_dispatcher import Dispatcher
from autograder.grading.running.worker_messages import JUDGE
from autograder.safe_files import HeldFolder, sweep

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.grading_task import Task
    from autograder.grading.running.task_dispatcher import Done

    Execute = Callable[..., Generator[Done, None, None]]
    """Executes tasks in the given order, and yields each result as soon as it is ready. The argument ``on_start`` is
    called when a task begins.
    """


@contextlib.contextmanager
def on_this_machine(directory: ClassDirectory, jobs: int | None, judge: str) -> Iterator[Execute]:
    """Yield a function that executes tasks on this machine.

    Args:
        jobs: The number of notebooks to execute at the same time; None for as many as processors and memory allow.
        judge: The Python class that makes a judge, as ``module:class``; empty for the real judge.

    Raises:
        GradingError: Submissions cannot be boxed on this machine.
    """
    require_sandbox(directory)
    boxed = not directory.is_sandbox_off
    with HeldFolder(directory.scratch_prefix) as scratch:
        yield functools.partial(
            execute_all,
            scratch=scratch.path,
            workers=jobs,
            judge=judge or JUDGE,
            boxed=boxed,
            overlays=directory.overlays,
        )


def remove_leftovers(directory: ClassDirectory) -> None:
    """Remove temporary files that a killed batch left behind.

    Call this only while holding the lock of the class, so that no other process uses the files.
    """
    sweep(directory.scratch_prefix)


_PER_CORE = 4
"""The maximum number of notebooks per processor at the same time. It is greater than one, because a notebook spends
most of its time waiting: for a timer, for ROS discovery, or for a program to start.
"""
BOX_BYTES = Limits().beside_bytes + 150_000_000
"""The memory in bytes that is reserved for each notebook with its sandbox and judge."""
_RESERVE_BYTES = 1_000_000_000


def execute_all(
    tasks: Iterable[Task],
    scratch: Path,
    workers: int | None = None,
    *,
    on_start: Callable[[Task], None] = lambda _: None,
    judge: str = JUDGE,
    boxed: bool = True,
    overlays: Sequence[Path] = (),
) -> Generator[Done, None, None]:
    """Execute tasks in parallel on this machine, and yield results as they are ready.

    Args:
        tasks: The tasks in the order in which they begin.
        scratch: The folder in which submissions run. The caller removes it.
        workers: The number of notebooks to execute at the same time; None for the number that :func:`at_once`
            returns.
        on_start: Called when a task begins.
        judge: The Python class of the judge, as ``module:class``.
        boxed: True if the tasks are executed in boxes.
        overlays: The workspaces that every box sees.
    """
    slots = workers or at_once(cores(), psutil.virtual_memory().available)
    words = (str(scratch), str(slots), *(["boxed"] if boxed else []))
    # In a process of its own, so that the process with the gradebook loads nothing that executes submissions.
    with ProcessLink(
        "autograder.grading.running.order_executor", *words, scratch=scratch, overlays=overlays
    ) as machine:
        dispatcher = Dispatcher(machine, judge)
        yield from dispatcher.execute_all(tasks, on_start)


def at_once(processors: int, free_bytes: int) -> int:
    """Return the default number of notebooks to execute at once: as many as fit into memory with ``BOX_BYTES`` each.

    Memory for the grader itself and for one build per processor is subtracted first. The result is at most
    ``_PER_CORE`` for each processor. A notebook that needs more than ``BOX_BYTES`` is later executed again, alone.
    """
    room = free_bytes - _RESERVE_BYTES - processors * BUILD_LIMITS.beside_bytes
    return max(1, min(processors * _PER_CORE, room // BOX_BYTES))


def cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


UNBOXED_NOTE = (
    "Graded without a sandbox: the submissions ran with all rights of the person who graded them, "
    "and could have changed any grade."
)
"""A warning that the report and every feedback page show if a class was graded without a sandbox."""


def require_sandbox(directory: ClassDirectory) -> None:
    """Check that submissions of this class can be boxed, or that the user allowed grading without boxes.

    Raises:
        GradingError: Submissions cannot be boxed, and the user did not allow grading without boxes.
    """
    if directory.is_sandbox_off:
        return
    from autograder.boxes.sandbox import why_impossible

    why = why_impossible()
    if why:
        raise GradingError(
            f"Submissions cannot be isolated from your files and from each other here: {why}. To grade "
            "them nevertheless, trusting every submission: --unsafe-no-sandbox, or "
            "c.WireExecute.unsafe_no_sandbox = True in nbgrader_config.py."
        )
