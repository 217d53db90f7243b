"""A ROS domain of one's own for each check, so that nobody else on the host is heard."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from autograder.judge import shared_memory
from autograder.ros_domain import NoFreeDomainError, claim_free_domain

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["NoFreeDomainError", "lease"]


@contextlib.contextmanager
def lease() -> Iterator[int]:
    """Hold a free domain id for as long as the block runs; the claim dies with the process, however it ends.

    What killed programs of earlier checks have left in shared memory is removed first.

    Raises:
        NoFreeDomainError: None was free.
    """
    shared_memory.remove_abandoned()
    claim = claim_free_domain()
    try:
        yield claim.domain
    finally:
        claim.release()
