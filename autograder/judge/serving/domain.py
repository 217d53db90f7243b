"""A ROS domain of one's own for each check, so that nobody else on the host is heard.

Before that, shared memory is removed that programs of earlier checks have left behind.
With discovery on this machine only, rmw_fastrtps lets each participant make half a megabyte of shared memory, whatever
the transports are said to be (participant.cpp). It is removed when the participant is, so a program that is killed
leaves it, and memory is lost until somebody runs ``fastdds shm clean``: a day of killed programs was 12 GB.
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
"""The files that are locked for as long as a segment's owner lives (Fast DDS, RobustExclusiveLock.hpp). What belongs to
a port has another name, is shared by several programs, and is used again."""
AGE = 60.0
"""Seconds after which a lock that nobody holds has lost its owner; one that is being made is a moment old."""


@contextlib.contextmanager
def lease(*, alone: bool = False) -> Iterator[int]:
    """Hold a free domain id for as long as the block runs; the claim dies with the process, however it ends.

    What killed programs of earlier checks have left in shared memory is removed first.

    Args:
        alone: Nobody is on this network but the one who is checked. One who takes the ports of all domains keeps
            nobody from a check then.

    Raises:
        NoFreeDomainError: None was free.
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
    """Remove the segments of this user's programs that no longer live.

    Args:
        folder: Where they are.
        age: Seconds since they were made; younger ones stay.
    """
    with contextlib.suppress(OSError):
        for lock in folder.glob(_LOCKS):
            with contextlib.suppress(OSError):
                remove_if_abandoned(lock, time.time() - age)


def remove_if_abandoned(lock: Path, made_before: float) -> None:
    """Remove a segment and its lock.

    Args:
        lock: Its lock.
        made_before: Seconds of Unix time; one that was made later stays.

    Raises:
        OSError: Its owner lives (BlockingIOError), or it is gone already.
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
