"""``autograder worker``: checks what this machine can do, then starts a Dask worker on it."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import signal
from typing import TYPE_CHECKING

import dask
from distributed import Worker

from autograder.boxes.sandbox import why_impossible
from autograder.grading.cluster.connection import check_address
from autograder.grading.errors import GradingError
from autograder.grading.rebuilding.course_version import course_version
from autograder.grading.running.dispatcher import SchedulerGone
from autograder.grading.running.orders import Offer
from autograder.temporary_folders import HeldFolder
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Callable

_CONNECT_SECONDS = 30
_GOODBYE_SECONDS = 2.0

_SETTINGS = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.gil.enabled": False,
}


def offer(slots: int) -> Offer:
    """Return this machine's offer to a cluster: the course version, and whether the machine can make boxes.

    Args:
        slots: The number of notebooks to execute at the same time.
    """
    return Offer(course_version(), slots, why_impossible())


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
    offered = offer(jobs or len(os.sched_getaffinity(0)))
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
        raise SchedulerGone(
            f"No Dask scheduler answers at {address} ({error}). Start one with: dask scheduler"
        ) from error
    told = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, told.set)
    tell(f"{name} waits for work from {address}. Ctrl-C ends it.")
    finished, stopped = asyncio.ensure_future(worker.finished()), asyncio.ensure_future(told.wait())
    await asyncio.wait((finished, stopped), return_when=asyncio.FIRST_COMPLETED)
    ended_by_scheduler = finished.done() and not stopped.done()
    stopped.cancel()
    with contextlib.suppress(Exception):
        await worker.close(timeout=_GOODBYE_SECONDS, executor_wait=False)
    if ended_by_scheduler:
        tell(f"{name} ends: the scheduler at {address} has ended, or has told the worker to end.")
