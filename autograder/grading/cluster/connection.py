"""The way into a cluster: connect, look who can be given work, and leave nothing behind."""

from __future__ import annotations

import contextlib
import importlib.util
import re  # noqa: TID251  (an instructor's address)
from typing import TYPE_CHECKING

from autograder.grading.cluster.link import Link
from autograder.grading.errors import GradingError
from autograder.grading.running.dispatcher import Dispatcher
from environment.installation import installing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


_ADDRESS = re.compile(r"(tcp|tls)://[^\s/]+:\d{1,5}")


def check_dask() -> None:
    """Make sure that Dask is there.

    Raises:
        GradingError: It is not.
    """
    if importlib.util.find_spec("distributed") is None:
        raise GradingError(
            "Grading on a cluster needs Dask, which is not installed here. "
            f"Type: {installing('cluster', clone='--with cluster')}"
        )


def check_address(address: str) -> None:
    """Make sure that this can be the address of a scheduler.

    Raises:
        GradingError: It is none.
    """
    if not _ADDRESS.fullmatch(address):
        raise GradingError(
            f"{address!r:.200} is no address of a Dask scheduler. One looks like tcp://host:8786, "
            "or tls://host:8786 where Dask is set up for TLS."
        )


@contextlib.contextmanager
def connected(
    address: str, *, judge: str, boxed: bool, tell: Callable[[str], None] = lambda _: None
) -> Iterator[Dispatcher]:
    """The acceptable workers of a cluster. Leaving it takes back whatever is queued, within seconds.

    Args:
        address: The scheduler's, such as ``tcp://host:8786`` or ``tls://host:8786``.
        judge: What makes a judge, as ``module:class``.
        boxed: Whether tasks are executed in boxes; a worker that cannot is refused then.
        tell: Called with a sentence for the instructor.

    Raises:
        GradingError: Dask is not installed.
        SchedulerGone: There is no scheduler at that address.
        NoWorkers: It has no worker that can be given work.
    """
    with Link(address) as link:
        pool = Dispatcher(link, address, judge=judge, boxed=boxed, tell=tell)
        pool.await_workers()
        yield pool
