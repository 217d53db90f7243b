"""Executes the tasks of a class on this machine, as many at the same time as the memory allows."""

from __future__ import annotations

import os
import queue
import threading
from typing import TYPE_CHECKING

import psutil

from autograder.boxes.limits import BUILD_LIMITS, Limits
from autograder.grading.running.dispatcher import Dispatcher, Done
from autograder.grading.running.orders import JUDGE
from autograder.grading.running.process_link import this_machine

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable
    from pathlib import Path

    from autograder.grading.task import Task

_PER_CORE = 4
"""The maximum number of notebooks per processor at the same time. It is greater than one, because a notebook spends
most of its time waiting: for a timer, for ROS discovery, or for a program to start.
"""
BOX_BYTES = Limits().beside_bytes + 150_000_000
"""The memory in bytes that is reserved for each notebook with its sandbox and judge."""
_RESERVE_BYTES = 1_000_000_000


def cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


def at_once(processors: int, free_bytes: int) -> int:
    """Return the default number of notebooks to execute at once: as many as fit into memory with ``BOX_BYTES`` each.

    Memory for the grader itself and for one build per processor is subtracted first. The result is at most
    ``_PER_CORE`` for each processor. A notebook that needs more than ``BOX_BYTES`` is later executed again, alone.
    """
    room = free_bytes - _RESERVE_BYTES - processors * BUILD_LIMITS.beside_bytes
    return max(1, min(processors * _PER_CORE, room // BOX_BYTES))


def execute_all(
    tasks: Iterable[Task],
    scratch: Path,
    workers: int | None = None,
    *,
    on_start: Callable[[Task], None] = lambda _: None,
    judge: str = JUDGE,
    boxed: bool = True,
) -> Generator[Done, None, None]:
    """Execute tasks in parallel on this machine, and yield results as they are ready.

    Args:
        tasks: The tasks in the order in which they begin.
        scratch: The folder in which submissions run. The caller removes it.
        workers: The number of notebooks to execute at the same time; None for the number that :func:`at_once`
            returns.
        on_start: Called in another thread when a task begins.
        judge: The Python class of the judge, as ``module:class``.
        boxed: True if the tasks are executed in boxes.
    """
    slots = workers or at_once(cores(), psutil.virtual_memory().available)
    with this_machine(scratch, slots, boxed=boxed) as machine:
        dispatcher = Dispatcher(machine, "", judge=judge, boxed=boxed, tell=lambda _: None)
        yield from dispatch(dispatcher, tasks, on_start)


def dispatch(
    dispatcher: Dispatcher, tasks: Iterable[Task], on_start: Callable[[Task], None]
) -> Generator[Done, None, None]:
    """Let a dispatcher execute tasks in another thread, so that free slots get tasks while the caller stores a result.

    If the caller leaves the loop early, the tasks that still run are ended.

    Args:
        dispatcher: The dispatcher. It cannot be used afterwards.
        tasks: The tasks in the order in which they begin. The next task is taken, in the other thread, when a slot is
            free.
        on_start: Called in the other thread when a task begins.
    """
    results: queue.SimpleQueue[Done | BaseException | None] = queue.SimpleQueue()

    def execute() -> None:
        try:
            for done in dispatcher.execute_all(tasks, on_start):
                results.put(done)
            results.put(None)
        except BaseException as error:  # pass the error on, because the caller waits for results
            results.put(error)

    thread = threading.Thread(target=execute, daemon=True)
    thread.start()
    try:
        while (result := results.get()) is not None:
            if isinstance(result, BaseException):
                raise result
            yield result
    finally:
        dispatcher.stop()
        thread.join()
