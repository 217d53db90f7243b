"""What a Dask worker does with an order.

A worker is given one task at a time and nothing beside it: no class, no secret, no name of a student.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
from distributed import Worker, WorkerPlugin, get_worker

from autograder.boxes.execution import Execution
from autograder.boxes.zero import grader_trouble
from autograder.grading.cluster.messages import LARGEST_ANSWER, Order
from autograder.grading.engine import KeptLane
from autograder.grading.task import Task, decode_task, encode

if TYPE_CHECKING:
    from collections.abc import Iterator


def execute(data: bytes) -> bytes:
    """Do an order; the execution as JSON.

    Args:
        data: An :class:`Order` as JSON.
    """
    order = msgspec.json.decode(data, type=Order)
    task = decode_task(bytes(order.task))
    with _lanes.one(order.judge, task.boxed) as lane:
        answer = encode(lane.execute(task))
    if len(answer) > LARGEST_ANSWER:
        return encode(_trouble(task, f"its result has {len(answer)} bytes"))
    return answer


def _trouble(task: Task, reason: str) -> Execution:
    verdicts = {i: grader_trouble(cell.check, reason) for i, cell in enumerate(task.cells) if cell.check}
    return Execution(cells=(), verdicts=verdicts, trouble=reason)


class _Lanes:
    """The lanes of this process, kept from order to order, each used by one thread at a time."""

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._idle: dict[tuple[str, bool], list[KeptLane]] = {}
        self._at_work: dict[str, KeptLane] = {}
        self._made = 0
        self._watched = False

    @contextlib.contextmanager
    def one(self, judge: str, boxed: bool) -> Iterator[KeptLane]:
        """A lane for one order. When the order is cancelled, what it runs is ended, and the lane is not kept."""
        worker = get_worker()
        key = str(worker.get_current_task())
        with self._changing:
            if not self._watched:
                self._watched = True
                worker.loop.add_callback(worker.plugin_add, plugin=_Watch(), name="autograder")
            idle = self._idle.setdefault((judge, boxed), [])
            lane = idle.pop() if idle else self._new(judge, boxed)
            self._at_work[key] = lane
        try:
            yield lane
        finally:
            with self._changing:
                if self._at_work.pop(key, None) is lane:
                    idle.append(lane)

    def cancel(self, key: str) -> None:
        """Nobody waits for this order any more."""
        with self._changing:
            lane = self._at_work.pop(key, None)
        if lane is not None:
            lane.stop()

    def stop(self) -> None:
        """End every lane and what it runs."""
        with self._changing:
            lanes = [*self._at_work.values(), *(lane for idle in self._idle.values() for lane in idle)]
            self._at_work.clear()
            self._idle.clear()
        for lane in lanes:
            lane.stop()

    def _new(self, judge: str, boxed: bool) -> KeptLane:
        self._made += 1
        # A short name: sockets are in there.
        base = Path(tempfile.gettempdir()) / f"autograder-{os.getuid()}-{os.getpid()}"
        return KeptLane(base / str(self._made), judge=judge, boxed=boxed)


_lanes = _Lanes()


class _Watch(WorkerPlugin):
    """Ends what a cancelled order runs; Dask itself lets it go on."""

    def transition(self, key: Any, start: str, finish: str, **_: Any) -> None:
        """Called by Dask when a task of the worker changes its state."""
        if start == "executing" and finish == "released":  # not "memory": nobody wants the result any more
            _lanes.cancel(key)

    def teardown(self, worker: Worker) -> None:  # noqa: ARG002  (Dask's signature)
        """Called by Dask when the worker ends."""
        _lanes.stop()
