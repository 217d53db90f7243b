"""The work of a Dask worker on an order.

A worker is given one task at a time and nothing beside it: no class, no secret, no name of a student.
"""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING, Any

import msgspec
from distributed import Worker, WorkerPlugin, get_worker

from autograder.grading.cluster.messages import LARGEST_ANSWER, Order
from autograder.grading.running.worker_process import WorkerProcess
from autograder.grading.task import Task
from autograder.temporary_folders import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Iterator


def execute(data: bytes) -> bytes:
    """Do an order; the execution as JSON.

    Args:
        data: An :class:`Order` as JSON.
    """
    order = msgspec.json.decode(data, type=Order)
    task = msgspec.json.decode(bytes(order.task), type=Task)
    with _processes.one(order.judge, task.boxed) as process:
        answer = msgspec.json.encode(process.execute(task))
    if len(answer) > LARGEST_ANSWER:
        return msgspec.json.encode(task.in_trouble(f"its result has {len(answer)} bytes"))
    return answer


class _Lanes:
    """The processes of this process, kept from order to order, each used by one thread at a time."""

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._idle: dict[tuple[str, bool], list[WorkerProcess]] = {}
        self._at_work: dict[str, WorkerProcess] = {}
        self._made = 0
        self._scratch: HeldFolder | None = None
        self._watched = False

    @contextlib.contextmanager
    def one(self, judge: str, boxed: bool) -> Iterator[WorkerProcess]:
        """A process for one order. When the order is cancelled, what it runs is ended, and the process is not kept."""
        worker = get_worker()
        key = str(worker.get_current_task())
        with self._changing:
            if not self._watched:
                self._watched = True
                worker.loop.add_callback(worker.plugin_add, plugin=_Watch(), name="autograder")
            idle = self._idle.setdefault((judge, boxed), [])
            process = idle.pop() if idle else self._new(judge, boxed)
            self._at_work[key] = process
        try:
            yield process
        finally:
            with self._changing:
                if self._at_work.pop(key, None) is process:
                    idle.append(process)

    def cancel(self, key: str) -> None:
        """Nobody waits for this order any more."""
        with self._changing:
            process = self._at_work.pop(key, None)
        if process is not None:
            process.stop()

    def stop(self) -> None:
        """End every process and what it runs."""
        with self._changing:
            processes = [
                *self._at_work.values(),
                *(process for idle in self._idle.values() for process in idle),
            ]
            self._at_work.clear()
            self._idle.clear()
            scratch, self._scratch = self._scratch, None
        for process in processes:
            process.stop()
        if scratch is not None:
            scratch.remove()

    def _new(self, judge: str, boxed: bool) -> WorkerProcess:
        self._made += 1
        if self._scratch is None:
            self._scratch = HeldFolder("autograder-worker-")
        return WorkerProcess(self._scratch.path / str(self._made), judge=judge, boxed=boxed)


_processes = _Lanes()


class _Watch(WorkerPlugin):
    """Ends what a cancelled order runs; Dask itself lets it go on."""

    def transition(self, key: Any, start: str, finish: str, **_: Any) -> None:
        """Called by Dask when a task of the worker changes its state."""
        if start == "executing" and finish == "released":  # not "memory": nobody wants the result any more
            _processes.cancel(key)

    def teardown(self, worker: Worker) -> None:  # noqa: ARG002  (Dask's signature)
        """Called by Dask when the worker ends."""
        _processes.stop()
