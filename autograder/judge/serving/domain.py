"""Lease a separate ROS domain for each check, so that other programs on this machine do not disturb it.

First, remove the shared memory that killed programs of earlier checks have left behind. If discovery is limited to
this machine, rmw_fastrtps creates half a megabyte of shared memory for each participant, whichever transports are
configured (participant.cpp). A program that is killed does not remove it, and the memory stays in use until ``fastdds
shm clean`` runs. One day of killed programs left 12 GB.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import random
import time
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.ros_domain import FREE_TO_PICK, NoFreeDomainError, claim_free_domain

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["NoFreeDomainError", "lease", "remove_abandoned", "remove_if_abandoned"]

FOLDER = Path("/dev/shm")
_SUFFIX = "_el"
_LOCKS = f"fastrtps_{'[0-9a-f]' * 16}{_SUFFIX}"
"""The names of lock files that Fast DDS locks for as long as the owner of a segment lives (RobustExclusiveLock.hpp).
The files of ports have other names; several programs share them, so they stay.
"""
AGE = 60.0
"""Age in seconds from which an unlocked lock file counts as abandoned. A younger one may just be being created."""


@contextlib.contextmanager
def lease(*, alone: bool = False) -> Iterator[int]:
    """Reserve a free domain id while the block runs. The reservation ends with the process, however it ends.

    Shared memory that killed programs of earlier checks left behind is removed first.

    Args:
        alone: True if only the judge and its subject are on this network. The check then works even if the
            subject has taken the ports of all domains.

    Raises:
        NoFreeDomainError: All domains are in use.
    """
    remove_abandoned()
    try:
        claim = claim_free_domain()
    except NoFreeDomainError:
        if not alone:
            raise
        yield random.choice(FREE_TO_PICK)
        return
    try:
        yield claim.domain
    finally:
        claim.release()


def remove_abandoned(folder: Path = FOLDER, age: float = AGE) -> None:
    """Remove the shared memory of this user's programs that have ended.

    Args:
        folder: The folder of the segments.
        age: Age in seconds. Younger segments stay.
    """
    with contextlib.suppress(OSError):
        for lock in folder.glob(_LOCKS):
            with contextlib.suppress(OSError):
                remove_if_abandoned(lock, time.time() - age)


def remove_if_abandoned(lock: Path, made_before: float) -> None:
    """Remove a segment and its lock file if its owner has ended.

    Args:
        lock: The lock file of the segment.
        made_before: Unix time in seconds. Younger segments stay.

    Raises:
        OSError: The owner still runs (BlockingIOError), or the segment no longer exists.
    """
    found = lock.lstat()
    if found.st_uid != os.getuid() or found.st_mtime > made_before:
        return
    held = os.open(lock, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        lock.with_name(lock.name.removesuffix(_SUFFIX)).unlink(missing_ok=True)
        lock.unlink(missing_ok=True)
    finally:
        os.close(held)
