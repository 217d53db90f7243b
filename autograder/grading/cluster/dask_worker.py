"""Executes orders in a Dask worker, as on the instructor's machine.

A worker gets one task at a time and nothing else: not the class, no secret, and not the student's name.
"""

from __future__ import annotations

import threading
from typing import Any

from distributed import Worker, WorkerPlugin, get_worker

from autograder.grading.running.this_machine import WorkerProcesses
from autograder.temporary_folders import HeldFolder

_changing = threading.Lock()
_scratch: HeldFolder | None = None
_processes: WorkerProcesses | None = None


def execute(data: bytes) -> bytes:
    """Execute an order, and return the execution as JSON.

    Args:
        data: An :class:`autograder.grading.running.orders.Order` as JSON.
    """
    global _scratch, _processes
    worker = get_worker()
    with _changing:
        if _processes is None:
            _scratch = HeldFolder("autograder-worker-")
            _processes = WorkerProcesses(_scratch.path)
            worker.loop.add_callback(worker.plugin_add, plugin=_Watch(), name="autograder")
        processes = _processes
    return processes.execute(str(worker.get_current_task()), data)


class _Watch(WorkerPlugin):
    """Ends the processes of a canceled order, because Dask itself would let them go on."""

    def transition(self, key: Any, start: str, finish: str, **_: Any) -> None:
        """End an order that was canceled. Dask calls this when a task of the worker changes its state."""
        if start == "executing" and finish == "released" and _processes is not None:
            _processes.cancel(key)

    def teardown(self, worker: Worker) -> None:  # noqa: ARG002  (Dask's signature)
        """End every worker process and what it runs. Dask calls this when the worker ends."""
        if _processes is not None:
            _processes.stop()
        if _scratch is not None:
            _scratch.remove()
