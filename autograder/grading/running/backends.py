"""The ways to execute tasks: on this machine, or on the workers of a Dask cluster."""

from __future__ import annotations

import contextlib
import functools
from typing import TYPE_CHECKING

from autograder.grading.running.orders import JUDGE
from autograder.temporary_folders import HeldFolder, sweep

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.running.dispatcher import Done
    from autograder.grading.task import Task

    Execute = Callable[[Iterable[Task], Callable[[Task], None]], Generator[Done, None, None]]
    """Executes tasks in the given order, and yields each result as soon as it is ready. The second argument is called
    when a task begins.
    """


def remove_leftovers(directory: ClassDirectory) -> None:
    """Remove temporary files that a killed batch left behind.

    Call this only while holding the lock of the class, so that no other process uses the files.
    """
    sweep(directory.scratch_prefix)


@contextlib.contextmanager
def local(directory: ClassDirectory, jobs: int | None, judge: str) -> Iterator[Execute]:
    """Yield a function that executes tasks on this machine.

    Args:
        directory: The class.
        jobs: The number of notebooks to execute at the same time; None for as many as processors and memory allow.
        judge: The Python class that makes a judge, as ``module:class``; empty for the real judge.

    Raises:
        SandboxMissing: Submissions cannot be boxed on this machine. The message says what to do.
    """
    from autograder.grading.running import engine, sandboxing

    sandboxing.require(directory)
    boxed = not sandboxing.switched_off(directory)

    def execute(tasks: Iterable[Task], on_start: Callable[[Task], None]) -> Generator[Done, None, None]:
        return engine.execute_all(
            tasks, scratch.path, jobs, on_start=on_start, judge=judge or JUDGE, boxed=boxed
        )

    with HeldFolder(directory.scratch_prefix) as scratch:
        yield execute


@contextlib.contextmanager
def cluster(
    directory: ClassDirectory, scheduler: str, judge: str, tell: Callable[[str], None]
) -> Iterator[Execute]:
    """Yield a function that executes tasks on the workers of a Dask cluster.

    Args:
        directory: The class.
        scheduler: The scheduler's address.
        judge: The Python class that makes a judge, as ``module:class``; empty for the real judge.
        tell: Called with a sentence for the instructor.

    Raises:
        GradingError: The cluster cannot be used. The message says why.
    """
    from autograder.grading.cluster.connection import connected
    from autograder.grading.running import engine, sandboxing

    boxed = not sandboxing.switched_off(directory)
    with connected(scheduler, judge=judge or JUDGE, boxed=boxed, tell=tell) as pool:
        yield functools.partial(engine.dispatch, pool)
