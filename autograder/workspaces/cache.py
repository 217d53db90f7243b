"""A cache of builds: one folder for each build, named by the key of its sources, that only its owner may use.

An entry is built at its final path (an install folder contains its own path) under a lock, and counts only once its
marker is written: an interrupted build is removed and repeated. If the builder is killed, as a kernel is when
JupyterLab restarts it, the build is ended, too, and holds the lock until none of its processes can write any more.
"""

from __future__ import annotations

import atexit
import contextlib
import fcntl
import functools
import os
import shutil
import stat
import time
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING

import platformdirs

from autograder.temporary_folders import fresh_folder
from autograder.workspaces.artefacts import BLOCK

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

VARIABLE = "AUTOGRADER_WORKSPACE_CACHE"
"""The variable that names another folder for the cache; a grader gives each box its own."""
LIMIT = 1_000_000_000
"""The limit on bytes of all entries together; one interface package takes two million."""
IN_USE = 900.0
"""Seconds after its last use in which an entry is not removed: its programs may run as long as a check lasts."""
ASK_EVERY = 0.1
"""Seconds between checks whether an entry is free, for callers who may give up."""
_MARKER = "complete"
_NAME = "ros2-course-autograder"


class GivenUp(RuntimeError):
    """The caller no longer needs the entry."""


@dataclass(frozen=True)
class CachedBuild:
    """A folder of the cache, locked while it is held.

    Attributes:
        folder: The path.
        complete: True if the entry contains a finished build.
        lock: The descriptor of its lock, which every process that writes into the folder holds, too.
    """

    folder: Path
    complete: bool
    lock: int

    def finish(self) -> None:
        """Mark the build as finished; it counts from now on."""
        (self.folder / _MARKER).write_text(self.folder.name, encoding="utf-8")


def root() -> Path:
    """Return the folder of the cache, which only this user owns and can open.

    A folder that another user owns or may write to is not used, because its builds would be run. Then a new temporary
    folder is used instead, and work goes on without earlier builds.
    """
    named = os.environ.get(VARIABLE)
    return _own(Path(named) if named else platformdirs.user_cache_path(_NAME) / "workspaces")


def graders_root() -> Path:
    """Return the folder for builds of the course's own packages: made in boxes, and shown to boxes only as needed."""
    return _own(platformdirs.user_cache_path(_NAME) / "graded-builds")


def _own(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        if is_ones_own(folder):
            return folder
    except OSError:
        pass
    return _in_place_of(folder)


@functools.cache
def _in_place_of(folder: Path) -> Path:
    """Make a folder for this process alone, which is removed when the process ends."""
    del folder
    made, owner = fresh_folder("workspace-builds-"), os.getpid()

    @atexit.register
    def remove() -> None:
        if os.getpid() == owner:  # not in a fork, which also runs this at its end
            shutil.rmtree(made, ignore_errors=True)

    return made


def is_ones_own(folder: Path) -> bool:
    """True if only this user may write to a folder."""
    found = folder.lstat()
    own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    return own and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def is_complete(key: str, base: Path) -> bool:
    """True if there is a finished entry, without waiting for a process that makes it."""
    return _is_of(key, base / key / _MARKER)


def _is_of(key: str, marker: Path) -> bool:
    """True if the marker was written for a build of this key, not for one whose folder was renamed since."""
    try:
        return marker.read_text(encoding="utf-8") == key
    except (OSError, UnicodeDecodeError):
        return False


@contextlib.contextmanager
def entry(key: str, base: Path, cancelled: Callable[[], bool] = lambda: False) -> Iterator[CachedBuild]:
    """Hold the entry of a key, so that no other process builds it at the same time.

    An unfinished entry is empty when it is given to the caller, and is removed if the caller does not finish it.

    Args:
        key: The key of the build.
        base: The cache.
        cancelled: Called from time to time while another process holds the entry; True gives up.

    Raises:
        GivenUp: The entry is no longer wanted.
    """
    with _turn(base / f"{key}.lock", cancelled) as lock:
        folder = base / key
        marker = folder / _MARKER
        complete = _is_of(key, marker) and is_ones_own(folder)
        if complete:
            os.utime(marker)
        else:
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(mode=0o700)
        try:
            yield CachedBuild(folder, complete, lock.fileno())
        finally:
            if not marker.is_file():
                shutil.rmtree(folder, ignore_errors=True)
    if not complete:
        make_room(base)


@contextlib.contextmanager
def _turn(file: Path, cancelled: Callable[[], bool]) -> Iterator[IO[str]]:
    """Hold a lock. Its last holder may have removed the file with its entry; then a new file is locked instead."""
    while True:
        with file.open("a") as lock:
            await_turn(lock.fileno(), cancelled)
            if _is_at(lock, file):
                yield lock
                return


def _is_at(lock: IO[str], file: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(lock.fileno()), file.stat())
    except FileNotFoundError:
        return False


def await_turn(lock: int, cancelled: Callable[[], bool]) -> None:
    """Take a lock once no other process has it.

    Args:
        lock: A descriptor of the locked file; closing it releases the lock.
        cancelled: Called from time to time; True gives up.

    Raises:
        GivenUp: The lock is no longer wanted.
    """
    while True:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            # No event tells that a lock is free, so this polls.
            if cancelled():
                raise GivenUp("nobody waits for the entry any more") from None
            time.sleep(ASK_EVERY)
        else:
            return


def make_room(base: Path, limit: int = LIMIT, in_use: float = IN_USE) -> list[str]:
    """Remove the least recently used entries, until all together take at most ``limit`` bytes.

    Remains of failed or killed builds are removed, too.

    Args:
        base: The cache.
        limit: The limit in bytes.
        in_use: Seconds after its last use in which an entry stays.

    Returns:
        The keys that were removed.
    """
    entries = sorted((used, folder) for folder in base.iterdir() if (used := _last_use(folder)) is not None)
    sizes = {folder: size_of(folder) for _, folder in entries}
    total = sum(sizes.values())
    removed = []
    for used, folder in entries:
        if total <= limit or time.time() - used < in_use:
            break
        if _remove(base, folder, used):
            total -= sizes[folder]
            removed.append(folder.name)
    for lock in base.glob("*.lock"):
        if _last_use(folder := lock.with_suffix("")) is None:
            _remove(base, folder, None)
    return removed


def _remove(base: Path, folder: Path, used: float | None) -> bool:
    """Remove an entry last used at this time, or never finished; False if another process uses it or has since."""
    file = base / f"{folder.name}.lock"
    with file.open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False  # another process uses it
        if not _is_at(lock, file) or _last_use(folder) != used:
            return False  # another process has just removed, made or used it
        # Without its marker the entry does not count, even if removing the rest fails.
        (folder / _MARKER).unlink(missing_ok=True)
        shutil.rmtree(folder, ignore_errors=True)
        file.unlink(missing_ok=True)
    return True


def _last_use(folder: Path) -> float | None:
    try:
        return (folder / _MARKER).stat().st_mtime
    except OSError:
        return None


def size_of(folder: Path) -> int:
    """Return the approximate disk space of a folder and everything in it, in bytes."""
    size = 0
    for root_, _, names in os.walk(folder):
        size += BLOCK
        for name in names:
            with contextlib.suppress(FileNotFoundError):  # another worker may be removing it
                size += BLOCK + Path(root_, name).lstat().st_size
    return size
