"""Lease a separate ROS domain for each check, so that other programs on this machine do not disturb it.

Also remove the shared memory that killed programs of earlier checks have left behind. If discovery is limited to this
machine, rmw_fastrtps creates half a megabyte of shared memory for each participant, even if no transport uses it
(participant.cpp). A program that is killed does not remove its memory, so the memory stays in use until ``fastdds shm
clean`` runs. In this way 12 GB were lost in one day.
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
"""A pattern for the lock files of shared memory segments. The program that owns a segment holds the segment's lock as
long as the program runs (RobustExclusiveLock.hpp). The pattern does not match segments for ports, which must stay
because several programs share them.
"""
AGE = 60.0
"""The age in seconds from which an unlocked lock file counts as abandoned. A younger lock file may be unlocked because
its owner has only just created it.
"""


@contextlib.contextmanager
def lease(*, alone: bool = False) -> Iterator[int]:
    """Reserve a free domain id while the block runs. The id becomes free again even if the process crashes.

    Shared memory that killed programs of earlier checks left behind is removed first.

    Args:
        alone: True if only the judge and its subject are on this network. In that case a random domain id is used if
            none is free, so that a subject cannot prevent its check by taking the ports of all domains.

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
        folder: The folder with the segments and their lock files.
        age: The minimum age in seconds of the segments to remove.
    """
    with contextlib.suppress(OSError):
        for lock in folder.glob(_LOCKS):
            with contextlib.suppress(OSError):
                remove_if_abandoned(lock, time.time() - age)


def remove_if_abandoned(lock: Path, made_before: float) -> None:
    """Remove a shared memory segment and its lock file if the program that owns them has ended.

    Args:
        lock: The path of the lock file.
        made_before: Unix time in seconds. Segments that were made later stay.

    Raises:
        OSError: The owner still runs (BlockingIOError), or the lock file no longer exists.
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
