"""Connects to a cluster, finds the workers that can be given work, and cleans up afterwards."""

from __future__ import annotations

import contextlib
import importlib.util
import re  # noqa: TID251  (an instructor's address)
from typing import TYPE_CHECKING

from autograder.grading.errors import GradingError
from autograder.grading.running.dispatcher import Dispatcher
from autograder.grading.running.process_link import client_of
from environment.installation import installing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


_ADDRESS = re.compile(r"(tcp|tls)://[^\s/]+:\d{1,5}")


def check_dask() -> None:
    """Check that Dask is installed.

    Raises:
        GradingError: Dask is not installed.
    """
    if importlib.util.find_spec("distributed") is None:
        raise GradingError(
            "Grading on a cluster needs Dask, which is not installed here. "
            f"Type: {installing('cluster', clone='--with cluster')}"
        )


def check_address(address: str) -> None:
    """Check that a text can be the address of a Dask scheduler.

    Raises:
        GradingError: The text is not such an address.
    """
    if not _ADDRESS.fullmatch(address):
        raise GradingError(
            f"{address!r:.200} is not an address of a Dask scheduler. An address looks like tcp://host:8786, "
            "or tls://host:8786 if Dask is set up for TLS."
        )


@contextlib.contextmanager
def connected(
    address: str, *, judge: str, boxed: bool, tell: Callable[[str], None] = lambda _: None
) -> Iterator[Dispatcher]:
    """Give access to the workers of a cluster that can be given work.

    At the end of the block, queued tasks are canceled within seconds.

    Args:
        address: The scheduler's address, such as ``tcp://host:8786`` or ``tls://host:8786``.
        judge: The class that makes a judge, as ``module:class``.
        boxed: True to execute tasks in boxes. Then a worker that cannot make boxes is rejected.
        tell: Called with a sentence for the instructor.

    Raises:
        GradingError: Dask is not installed.
        SchedulerGone: No scheduler answers at this address.
        NoWorkers: The scheduler has no worker that can be given work.
    """
    with client_of(address) as link:
        pool = Dispatcher(link, address, judge=judge, boxed=boxed, tell=tell)
        pool.await_workers()
        yield pool
