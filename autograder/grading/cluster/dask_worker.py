"""Executes orders in a Dask worker, in the same way as on the instructor's machine.

A worker gets only the tasks that it executes: no other files of the class, no secrets, and no names of students.
"""

from __future__ import annotations

import threading
from typing import Any

from distributed import Worker, WorkerPlugin, get_worker

from autograder.grading.running.executor import Executor
from autograder.temporary_folders import HeldFolder

_changing = threading.Lock()
_scratch: HeldFolder | None = None
_executor: Executor | None = None


def execute(data: bytes) -> bytes:
    """Execute an order, and return the execution as JSON.

    Args:
        data: An :class:`autograder.grading.running.orders.Order` as JSON.
    """
    global _scratch, _executor
    worker = get_worker()
    with _changing:
        if _executor is None:
            _scratch = HeldFolder("autograder-worker-")
            _executor = Executor(_scratch.path)
            worker.loop.add_callback(worker.plugin_add, plugin=_Watch(), name="autograder")
        executor = _executor
    return executor.execute(str(worker.get_current_task()), data)


class _Watch(WorkerPlugin):
    """Ends the processes of canceled orders, which Dask itself would let run on."""

    def transition(self, key: Any, start: str, finish: str, **_: Any) -> None:
        """End an order if it was canceled. Dask calls this when a task of the worker changes its state."""
        if start == "executing" and finish == "released" and _executor is not None:
            _executor.cancel(key)

    def teardown(self, worker: Worker) -> None:  # noqa: ARG002  (Dask's signature)
        """End the processes of all orders. Dask calls this when the worker ends."""
        if _executor is not None:
            _executor.stop()
        if _scratch is not None:
            _scratch.remove()
