"""Sets up ROS for a check: environment variables, a folder for logs, and a ROS domain that no other program uses.

A participant of Jazzy's Fast DDS announces itself every 3 s (measured). So an older participant often discovers a new
process only seconds after the process has started. Therefore the judge's participants use the profile next to this
file, with which they announce themselves every 100 ms. Subjects do not need the profile.

If discovery is limited to this machine, rmw_fastrtps creates half a megabyte of shared memory for each participant,
even if no transport uses it (participant.cpp). A program that is killed does not remove its memory, so the memory stays
in use until ``fastdds shm clean`` runs. In this way 12 GB were lost in one day. So the shared memory that killed
programs of earlier checks have left behind is removed before each check.
"""

from __future__ import annotations

import atexit
import contextlib
import fcntl
import os
import random
import time
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.dds_discovery import FREE_TO_PICK, NoFreeDomainError, claim_free_domain
from autograder.safe_files import HeldFolder
from course_runtime.python_child import TYPED_PYTHONPATH

if TYPE_CHECKING:
    from collections.abc import Iterator


_LOG_FOLDER = "ROS_LOG_DIR"
PROFILE = Path(__file__).with_name("fastdds_profile.xml")
OF_THE_JUDGE = {
    "FASTDDS_DEFAULT_PROFILES_FILE": str(PROFILE),
    "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILE),
    # Without this variable, Fast DDS also reads a file DEFAULT_FASTRTPS_PROFILES.xml in the current folder.
    "SKIP_DEFAULT_XML_FILE": "1",
}
"""Environment variables for the judge's process that a subject must not have."""


def ros_environment() -> dict[str, str]:
    """Return the environment variables for judge and subject: ROS on loopback only, plain logs, messages over UDP.

    Messages go over UDP and not through shared memory, because two sandboxes have no memory in common. But because
    discovery is limited to this machine, rmw_fastrtps creates shared memory that no message uses. If a killed program
    leaves such memory behind, :mod:`autograder.judge.ros_setup` removes it.
    """
    return {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
        "RCUTILS_COLORIZED_OUTPUT": "0",
        "RCUTILS_LOGGING_USE_STDOUT": "1",
    }


def boxed_ros_environment() -> dict[str, str]:
    """Return the environment variables for judge and subject in two sandboxes that have only a network in common.

    The discovery range is not limited to this machine here, because rmw_fastrtps would then ignore
    ``FASTDDS_BUILTIN_TRANSPORTS`` and use shared memory (participant.cpp): judge and subject would discover each other,
    but no message would arrive. A limit is not needed, because no other program is on such a network.
    """
    return {**ros_environment(), "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}


def prepare_judge(*, boxed: bool = False) -> None:
    """Set the environment variables of this process for a judge. Call this before rclpy is imported.

    Args:
        boxed: True if only the judge and its subject are on this network.
    """
    os.environ.update(boxed_ros_environment() if boxed else ros_environment())
    os.environ.update(OF_THE_JUDGE)
    os.environ.pop("RMW_IMPLEMENTATION", None)
    provide_log_folder()


def subject_environment(domain_id: int, *, boxed: bool = False) -> dict[str, str]:
    """Return the environment variables for a command: the user's own variables, and the ROS domain of the check."""
    environment = {name: value for name, value in os.environ.items() if name not in OF_THE_JUDGE}
    if typed := environment.pop(TYPED_PYTHONPATH, ""):
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, (typed, environment.get("PYTHONPATH"))))
    environment.update(boxed_ros_environment() if boxed else ros_environment())
    environment["ROS_DOMAIN_ID"] = str(domain_id)
    environment["PYTHONUNBUFFERED"] = "1"
    # With this variable, a Python program that hangs prints the stacks of its threads when the judge aborts it.
    environment["PYTHONFAULTHANDLER"] = "1"
    return environment


def provide_log_folder() -> None:
    """Create a folder for ROS logs unless ``ROS_LOG_DIR`` names one. The folder is removed when this process ends.

    Without a folder for logs, rclpy does not start: rcl_logging_spdlog reports "Failed opening file".
    """
    if not os.environ.get(_LOG_FOLDER):
        folder, owner = HeldFolder("autograder-ros-logs-"), os.getpid()
        os.environ[_LOG_FOLDER] = str(folder.path)

        @atexit.register
        def remove() -> None:
            if os.getpid() == owner:  # a forked child that exits must not remove the folder
                folder.remove()


SHARED_MEMORY = Path("/dev/shm")
_LOCK_SUFFIX = "_el"
_LOCKS = f"fastrtps_{'[0-9a-f]' * 16}{_LOCK_SUFFIX}"
"""A pattern for the lock files of shared memory segments. The program that owns a segment holds the segment's lock as
long as the program runs (RobustExclusiveLock.hpp). The pattern does not match segments for ports, which must stay
because several programs share them.
"""
ABANDONED_AFTER = 60.0
"""The age in seconds from which an unlocked lock file counts as abandoned. A younger lock file may be unlocked because
its owner has only just created it.
"""


@contextlib.contextmanager
def lease_domain(*, alone: bool = False) -> Iterator[int]:
    """Reserve a free domain id while the block runs. The id becomes free again even if the process crashes.

    Shared memory that killed programs of earlier checks left behind is removed first.

    Args:
        alone: True if only the judge and its subject are on this network. In that case a random domain id is used if
            none is free, so that a subject cannot prevent its check by taking the ports of all domains.

    Raises:
        NoFreeDomainError: All domains are in use.
    """
    remove_abandoned_memory()
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


def remove_abandoned_memory(folder: Path = SHARED_MEMORY, age: float = ABANDONED_AFTER) -> None:
    """Remove the shared memory of this user's programs that have ended.

    Args:
        folder: The folder with the segments and their lock files.
        age: The minimum age in seconds of the segments to remove.
    """
    with contextlib.suppress(OSError):
        for lock in folder.glob(_LOCKS):
            with contextlib.suppress(OSError):
                remove_memory_if_abandoned(lock, time.time() - age)


def remove_memory_if_abandoned(lock: Path, made_before: float) -> None:
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
        lock.with_name(lock.name.removesuffix(_LOCK_SUFFIX)).unlink(missing_ok=True)
        lock.unlink(missing_ok=True)
    finally:
        os.close(held)
