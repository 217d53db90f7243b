"""Starts a Dask worker on this machine (``autograder worker``), and executes orders in it.

Orders are executed in the same way as on the instructor's machine. A worker gets only the tasks that it executes: no
other files of the class, no secrets, and no names of students.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import signal
import threading
from typing import TYPE_CHECKING, Any

import dask
from distributed import Worker, WorkerPlugin, get_worker

from autograder.boxes.sandbox import why_impossible
from autograder.command_name import COMMAND
from autograder.grading.cluster.cluster_dispatcher import check_address
from autograder.grading.course_version import course_version
from autograder.grading.grading_errors import GradingError
from autograder.grading.running.execution_backends import cores
from autograder.grading.running.order_executor import Executor
from autograder.grading.running.worker_messages import Offer
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Callable


_CONNECT_SECONDS = 30
_GOODBYE_SECONDS = 2.0
_SETTINGS = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.gil.enabled": False,
}


def start_worker(
    address: str | None, *, jobs: int | None, name: str | None, sandbox: bool, tell: Callable[[str], None]
) -> None:
    """Run a Dask worker until its scheduler ends, or until this process gets SIGINT (Ctrl-C) or SIGTERM.

    Args:
        address: The scheduler's address; by default the one in Dask's own settings.
        jobs: The number of notebooks to execute at the same time; by default the number of processors.
        name: The worker's name in messages; by default ``DASK_WORKER_NAME``, or else the host and the process id.
        sandbox: True to start only if boxes are possible on this machine.
        tell: Called with lines about the offer, and about the beginning and end of the work.

    Raises:
        GradingError: The address is missing or wrong, the scheduler does not answer, or a sandbox is required and
            cannot be made here.
    """
    address = address or os.environ.get("DASK_SCHEDULER_ADDRESS")
    if not address:
        raise GradingError(
            f"The scheduler's address is missing. Type, for example: {COMMAND} worker tcp://host:8786"
        )
    check_address(address)
    name = name or os.environ.get("DASK_WORKER_NAME") or f"{os.uname().nodename}-{os.getpid()}"
    # Refuse here what the grader would refuse later, while a person still watches this terminal.
    offered = offer(jobs or cores())
    if sandbox and offered.obstacle:
        raise GradingError(
            f"No sandbox is possible here: {offered.obstacle}. If you trust all submissions like your own programs, "
            "add --unsafe-no-sandbox to run them without a sandbox."
        )
    tell(
        f"{name} can execute {offered.slots} notebooks at the same time, "
        f"{'WITHOUT a sandbox' if offered.obstacle else 'in boxes'}, with course version {course_version()}."
    )
    logging.getLogger("distributed").setLevel(logging.ERROR)
    with dask.config.set(_SETTINGS), HeldFolder("autograder-dask-") as folder:
        asyncio.run(_work(address, name, offered.slots, str(folder.path), tell))


async def _work(address: str, name: str, slots: int, folder: str, tell: Callable[[str], None]) -> None:
    try:
        worker = Worker(
            address,
            name=name,
            nthreads=slots,
            memory_limit=0,  # no limit by Dask: submissions run in other processes, with limits of their own
            dashboard=False,
            local_directory=folder,
            death_timeout=_CONNECT_SECONDS,
        )
        await worker
    except (OSError, ValueError, TimeoutError) as error:
        raise GradingError(
            f"No Dask scheduler answers at {address} ({error}). Start one with: dask scheduler"
        ) from error
    signaled = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, signaled.set)
    tell(f"{name} waits for work from {address}. Ctrl-C ends it.")
    finished, stopped = asyncio.ensure_future(worker.finished()), asyncio.ensure_future(signaled.wait())
    await asyncio.wait((finished, stopped), return_when=asyncio.FIRST_COMPLETED)
    ended_by_scheduler = finished.done() and not stopped.done()
    stopped.cancel()
    with contextlib.suppress(Exception):
        await worker.close(timeout=_GOODBYE_SECONDS, executor_wait=False)
    if ended_by_scheduler:
        tell(f"{name} ends: the scheduler at {address} has ended, or has told the worker to end.")


def offer(slots: int) -> Offer:
    """Return this machine's offer to a cluster: the course version, and whether the machine can make boxes.

    Args:
        slots: The number of notebooks to execute at the same time.
    """
    return Offer(course_version(), slots, why_impossible())


class _Orders(WorkerPlugin):
    """Executes the orders of a Dask worker, and ends the processes of canceled orders, which Dask would let run on."""

    def __init__(self) -> None:
        self._scratch = HeldFolder("autograder-worker-")
        self.executor = Executor(self._scratch.path)

    def transition(self, key: Any, start: str, finish: str, **_: Any) -> None:
        """End an order if it was canceled. Dask calls this when a task of the worker changes its state."""
        if start == "executing" and finish == "released":
            self.executor.cancel(key)

    def teardown(self, worker: Worker) -> None:  # noqa: ARG002  (Dask's signature)
        """End the processes of all orders. Dask calls this when the worker ends."""
        self.executor.stop()
        self._scratch.remove()


_changing = threading.Lock()
_orders: _Orders | None = None


def execute(data: bytes) -> bytes:
    """Execute an order, and return the execution as JSON.

    Args:
        data: An :class:`autograder.grading.running.worker_messages.Order` as JSON.
    """
    global _orders
    worker = get_worker()
    with _changing:
        if _orders is None:
            _orders = _Orders()
            worker.loop.add_callback(worker.plugin_add, plugin=_orders, name="autograder")
        executor = _orders.executor
    return executor.execute(str(worker.get_current_task()), data)
