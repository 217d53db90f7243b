"""Execute the tasks of a class on this machine, as many at once as it has memory for."""

from __future__ import annotations

import os
import queue
import threading
from typing import TYPE_CHECKING

import psutil

from autograder.boxes.limits import BUILD_LIMITS, Limits
from autograder.grading.running.dispatcher import Dispatcher, Done
from autograder.grading.running.orders import JUDGE
from autograder.grading.running.this_machine import ThisMachine

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable
    from pathlib import Path

    from autograder.grading.task import Task

_PER_CORE = 4
"""Notebooks for each processor: a notebook mostly waits for a timer, for discovery or for the start of a program."""
BOX_BYTES = Limits().beside_bytes + 150_000_000
"""Memory that one more notebook may take, with its sandbox, judge and worker process."""
_RESERVE_BYTES = 1_000_000_000


def cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


def at_once(processors: int, free_bytes: int) -> int:
    """Return the default number of notebooks at once: all of them fit into memory if each takes its whole share.

    One build on each processor has memory, too. A notebook that needs more than its share is executed again, alone.
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
) -> Generator[Done, None, None]:
    """Execute tasks in parallel, and yield results as they are ready.

    Leaving the loop early ends every worker process and what it runs.

    Args:
        tasks: The tasks in the order in which they begin; a thread takes each of them when there is a slot for it.
        scratch: The folder in which submissions run. The caller removes it.
        workers: The number of notebooks at once; None for the number from :func:`at_once`.
        on_start: Called from a thread when a task begins.
        judge: The class of the judge, as ``module:class``.
    """
    slots = workers or at_once(cores(), psutil.virtual_memory().available)
    results: queue.SimpleQueue[Done | BaseException | None] = queue.SimpleQueue()
    with ThisMachine(scratch, slots) as machine:
        dispatcher = Dispatcher(machine, "", judge=judge, boxed=True, tell=lambda _: None)

        def dispatch() -> None:
            """Dispatch in a thread, so that no slot is empty while the caller stores a result."""
            try:
                for done in dispatcher.execute_all(tasks, on_start):
                    results.put(done)
                results.put(None)
            except BaseException as error:  # the caller waits for results
                results.put(error)

        thread = threading.Thread(target=dispatch, daemon=True)
        thread.start()
        try:
            while (result := results.get()) is not None:
                if isinstance(result, BaseException):
                    raise result
                yield result
        finally:
            machine.stop()
            thread.join()
