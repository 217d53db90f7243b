"""Connects to a Dask cluster, and finds the workers that can execute tasks."""

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
    """Check that ``address`` has the form of a Dask scheduler's address, such as ``tcp://host:8786``.

    Raises:
        GradingError: The address has another form.
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
    """Connect to a Dask cluster, and yield a dispatcher that gives tasks to its workers.

    At the end of the ``with`` block, the tasks that are not finished are canceled within seconds.

    Args:
        address: The scheduler's address, such as ``tcp://host:8786`` or ``tls://host:8786``.
        judge: The Python class that makes a judge, as ``module:class``.
        boxed: True to execute tasks in boxes. Workers that cannot make boxes are then rejected.
        tell: Called with a sentence for the instructor.

    Raises:
        GradingError: Dask is not installed.
        SchedulerGone: No scheduler answers at this address.
        NoWorkers: The scheduler has no workers, or none of them can execute tasks.
    """
    with client_of(address) as link:
        pool = Dispatcher(link, address, judge=judge, boxed=boxed, tell=tell)
        pool.await_workers()
        yield pool
