"""Executes orders on this machine, for the dispatcher of a class or for a Dask worker."""

from __future__ import annotations

import contextlib
import queue
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Self

import msgspec

from autograder.grading.running.orders import (
    ADDRESS,
    LARGEST_ANSWER,
    Answered,
    Broken,
    Command,
    Failed,
    Give,
    Joined,
    News,
    Offer,
    Order,
)
from autograder.grading.running.worker_process import GOODBYE_SECONDS, WorkerProcess
from autograder.grading.task import Task

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_STOPPED = Broken("the run was stopped")


class WorkerProcesses:
    """The worker processes of this machine. They are kept from order to order; only one thread at a time uses each.

    Args:
        scratch: The folder in which submissions run. Each process gets a separate folder in it.
    """

    def __init__(self, scratch: Path) -> None:
        self._scratch = scratch
        self._changing = threading.Lock()
        self._idle: dict[tuple[str, bool], list[WorkerProcess]] = {}
        self._at_work: dict[str, WorkerProcess] = {}
        self._made: list[WorkerProcess] = []
        self._stopped = False

    def execute(self, key: str, data: bytes) -> bytes:
        """Execute an order, and return the execution as JSON.

        Args:
            key: A key for the order, for use in :meth:`cancel`.
            data: An :class:`autograder.grading.running.orders.Order` as JSON.
        """
        order = msgspec.json.decode(data, type=Order)
        task = msgspec.json.decode(bytes(order.task), type=Task)
        with self._process(key, order.judge, boxed=task.boxed) as process:
            answer = msgspec.json.encode(process.execute(task))
        if len(answer) > LARGEST_ANSWER:
            return msgspec.json.encode(task.in_trouble(f"its result has {len(answer)} bytes"))
        return answer

    def cancel(self, key: str) -> None:
        """End everything that an order runs, because its answer is no longer needed."""
        with self._changing:
            process = self._at_work.pop(key, None)
        if process is not None:
            process.stop()

    def stop(self) -> None:
        """Ask every process to end, with everything that it runs."""
        with self._changing:
            self._stopped = True
            made = list(self._made)
        for process in made:
            process.stop()

    def kill(self) -> None:
        """Kill the processes that are still working after :meth:`stop`."""
        with self._changing:
            busy = list(self._at_work.values())
        for process in busy:
            process.kill()

    def end(self) -> None:
        """Wait for all processes to end. Call :meth:`stop` first; no thread may be using a process."""
        for process in self._made:
            process.end()

    @contextlib.contextmanager
    def _process(self, key: str, judge: str, *, boxed: bool) -> Iterator[WorkerProcess]:
        """Reserve a worker process for one order. If the order is canceled, the process is not used again."""
        with self._changing:
            idle = self._idle.setdefault((judge, boxed), [])
            process = idle.pop() if idle else self._new(judge, boxed=boxed)
            self._at_work[key] = process
        try:
            yield process
        finally:
            with self._changing:
                canceled = self._at_work.pop(key, None) is None
                if not canceled:
                    idle.append(process)
            if canceled:
                process.end()

    def _new(self, judge: str, *, boxed: bool) -> WorkerProcess:
        self._made.append(WorkerProcess(self._scratch / str(len(self._made)), judge=judge, boxed=boxed))
        if self._stopped:
            self._made[-1].stop()
        return self._made[-1]


class ThisMachine:
    """Executes the dispatcher's orders here. It has the same interface as the connection to a cluster.

    Args:
        scratch: The folder in which submissions run.
        slots: The number of notebooks to execute at the same time.
    """

    def __init__(self, scratch: Path, slots: int) -> None:
        self._processes = WorkerProcesses(scratch)
        self._threads = ThreadPoolExecutor(slots, "worker")
        self._news: queue.SimpleQueue[News] = queue.SimpleQueue()
        self._stopped = False
        offer = msgspec.json.encode(Offer("", slots, ""))
        self._news.put(Joined(ADDRESS, ADDRESS, offer))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """End all worker processes and what they run, within a few seconds."""
        self._processes.stop()
        ended = threading.Thread(target=self._threads.shutdown, daemon=True)
        ended.start()
        ended.join(GOODBYE_SECONDS)
        self._processes.kill()
        ended.join()
        self._processes.end()

    def say(self, command: Command) -> None:
        """Carry out a command of the dispatcher."""
        if isinstance(command, Give):
            self._threads.submit(self._execute, command)
        else:
            self._processes.cancel(str(command.number))

    def hear(self, within: float | None) -> News | None:
        """Return the next message; None if none came in time.

        Args:
            within: The limit in seconds; None for no limit.
        """
        try:
            news = self._news.get(timeout=None if within is None else max(0.0, within))
        except queue.Empty:
            return None
        return _STOPPED if self._stopped else news

    def stop(self) -> None:
        """Let the dispatcher receive no more messages, so that it gives out no more tasks."""
        self._stopped = True
        self._news.put(_STOPPED)

    def _execute(self, give: Give) -> None:
        try:
            self._news.put(Answered(give.number, self._processes.execute(str(give.number), give.order)))
        except BaseException as error:  # answer with the error, because the dispatcher waits for an answer
            self._news.put(Failed(give.number, f"{type(error).__name__}: {error}"))
