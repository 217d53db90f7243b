"""Executing tasks side by side, each in a worker process of its own, as many at once as the machine has memory for."""

from __future__ import annotations

import bisect
import operator
import os
import queue
import threading
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import psutil

from autograder.boxes.limits import Limits
from autograder.grading.running.worker import JUDGE
from autograder.grading.running.worker_process import GOODBYE_SECONDS, WorkerProcess
from autograder.workspaces.boxed_jobs import BUILD_LIMITS

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator
    from pathlib import Path

    from autograder.boxes.execution import Execution
    from autograder.grading.task import Task

_PER_CORE = 4
"""A notebook mostly waits: for a timer, for a discovery, for a program to start."""
BOX_BYTES = Limits().beside_bytes + 150_000_000
"""Memory that one more notebook may take: its box, its judge and its worker."""
_RESERVE_BYTES = 1_000_000_000


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0))


def at_once(processors: int, free_bytes: int) -> int:
    """Notebooks that run at once by default, never more than have memory if each takes all of its share.

    Enough is kept for one build on each processor. What needs more than its share is executed again, alone.
    """
    room = free_bytes - _RESERVE_BYTES - processors * BUILD_LIMITS.beside_bytes
    return max(1, min(processors * _PER_CORE, room // BOX_BYTES))


@dataclass(frozen=True)
class Done:
    """A task that was executed, or could not be."""

    task: Task
    execution: Execution


def execute_all(
    tasks: Iterable[Task],
    scratch: Path,
    workers: int | None = None,
    *,
    on_start: Callable[[Task], None] = lambda _: None,
    judge: str = JUDGE,
) -> Generator[Done, None, None]:
    """Execute tasks in parallel; results come as they are ready.

    Leaving the loop early ends every worker and what it runs.

    Args:
        tasks: In the order in which they are begun; each is asked for, from a thread, when there is a place for it.
        scratch: Where submissions run. The caller removes it.
        workers: How many run at once; as many as :func:`at_once` says where it is None.
        on_start: Called from a thread when a task is begun.
        judge: What makes a judge, as ``module:class``.
    """
    workers = workers or at_once(cores(), psutil.virtual_memory().available)
    crew = _Crew(_Feed(tasks), scratch, workers, judge, on_start)
    try:
        crew.start()
        yield from crew.results()
    finally:
        crew.end()


class _Feed:
    """Tasks, for many threads.

    What could not be checked, or was crowded out, comes once more when everything else is done, one at a time: whatever
    the machine was short of was perhaps used up by another submission. So it has all of its limits anew. Who has used
    the most processor time comes last.
    """

    def __init__(self, tasks: Iterable[Task]) -> None:
        self._tasks: Iterator[Task] = iter(tasks)
        self._changed = threading.Condition()
        self._again: list[tuple[float, Task]] = []
        self._running = 0
        self.taken = 0
        self.exhausted = False

    def next(self) -> tuple[Task, bool] | None:
        """The next task, and whether it comes for the first time; None where there is none.

        To be followed by :meth:`done`.
        """
        with self._changed:
            task = None if self.exhausted else next(self._tasks, None)
            if task is not None:
                self.taken += 1
                self._running += 1
                return task, True
            self.exhausted = True
            if not self._again:
                return None
            self._changed.wait_for(lambda: self._running == 0)
            if not self._again:
                return None
            self._running += 1
            _, task = self._again.pop(0)
            return task, False

    def done(self, again: tuple[float, Task] | None = None) -> None:
        """A task is done, or is to come again: the processor time that it has used, and the task."""
        with self._changed:
            self._running -= 1
            if again is not None:
                bisect.insort(self._again, again, key=operator.itemgetter(0))
            self._changed.notify_all()


class _Crew:
    """The workers of a run, each with a thread that speaks with it."""

    def __init__(
        self, feed: _Feed, scratch: Path, number: int, judge: str, on_start: Callable[[Task], None]
    ) -> None:
        self._feed, self._scratch, self._number = feed, scratch, number
        self._judge, self._on_start = judge, on_start
        # None says that a thread has found nothing more to do, so that who waits for results looks again.
        self._done: queue.SimpleQueue[Done | BaseException | None] = queue.SimpleQueue()
        self._threads: list[_WorkerThread] = []

    def start(self) -> None:
        """Begin with the first tasks."""
        for number in range(self._number):
            worker = WorkerProcess(self._scratch / str(number), judge=self._judge)
            beside = self._number > 1
            self._threads.append(_WorkerThread(worker, self._feed, self._done, self._on_start, beside=beside))
            self._threads[-1].start()
            if self._feed.exhausted:
                break

    def results(self) -> Iterator[Done]:
        """Results until the last task is done."""
        received = 0
        while not (self._feed.exhausted and received == self._feed.taken):
            result = self._done.get()
            if isinstance(result, BaseException):
                raise result
            if result is not None:
                received += 1
                yield result

    def end(self) -> None:
        """End every worker and what it runs."""
        self._feed.exhausted = True
        for thread in self._threads:
            thread.worker.stop()
        deadline = time.monotonic() + GOODBYE_SECONDS
        for thread in self._threads:
            thread.join(max(0.0, deadline - time.monotonic()))
        for thread in self._threads:
            thread.worker.kill()
        for thread in self._threads:
            thread.join()


class _WorkerThread(threading.Thread):
    """Takes task after task until none is left."""

    def __init__(
        self,
        worker: WorkerProcess,
        feed: _Feed,
        done: queue.SimpleQueue[Done | BaseException | None],
        on_start: Callable[[Task], None],
        *,
        beside: bool,
    ) -> None:
        super().__init__(daemon=True)
        self.worker = worker
        self._beside = beside
        self._feed, self._done, self._on_start = feed, done, on_start

    def run(self) -> None:
        """The thread's life."""
        try:
            while not self.worker.stopping and (given := self._feed.next()) is not None:
                self._execute(*given)
        except BaseException as error:  # the main thread waits for results: tell it
            self._done.put(error)
        finally:
            self._done.put(None)
            self.worker.end()

    def _execute(self, task: Task, first: bool) -> None:
        again = None
        try:
            if first:
                self._on_start(task)
            execution = self.worker.execute(task.beside_others(self._beside and first))
            if execution.says_nothing and first and not self.worker.stopping:
                again = (execution.cpu_seconds, task)
            else:
                self._done.put(Done(task, execution))
        finally:
            self._feed.done(again)
