"""A cache of builds: one folder for each build, named by the key of its sources. Only its owner may use it.

An entry is built at its final path, because an install folder contains its own path. This happens under a lock, and
the entry counts only once its marker is written, so an interrupted build is removed and repeated. If the builder is
killed, as a kernel is when JupyterLab restarts it, the build is ended, too; it holds the lock until none of its
processes can write any more.
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
from autograder.workspaces.builds.artefacts import BLOCK

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

VARIABLE = "AUTOGRADER_WORKSPACE_CACHE"
"""The environment variable for the path of the cache. A grader gives each box a separate one."""
LIMIT = 1_000_000_000
"""The maximum size in bytes of all entries together; one interface package takes two million."""
IN_USE = 900.0
"""Seconds for which an entry is kept after its last use, because its programs may run as long as a check lasts."""
ASK_EVERY = 0.1
"""Seconds between two checks whether an entry is free, for callers that may give up waiting."""
_MARKER = "complete"
_NAME = "ros2-course-autograder"


class GivenUp(RuntimeError):
    """The caller no longer needs the entry."""


@dataclass(frozen=True)
class CachedBuild:
    """A folder of the cache, locked while the caller uses it.

    Attributes:
        folder: The path of the folder.
        complete: True if the entry contains a finished build.
        lock: The descriptor of the lock. Every process that writes into the folder holds it, too.
    """

    folder: Path
    complete: bool
    lock: int

    def finish(self) -> None:
        """Mark the build as finished. From now on the entry counts."""
        (self.folder / _MARKER).write_text(self.folder.name, encoding="utf-8")


def root() -> Path:
    """Return the folder of the cache, which only this user owns and can open.

    If another user owns the folder or may write to it, it is not used, because programs from it would be run. A new
    temporary folder is used instead, without the earlier builds.
    """
    named = os.environ.get(VARIABLE)
    return _own(Path(named) if named else platformdirs.user_cache_path(_NAME) / "workspaces")


def graders_root() -> Path:
    """Return the folder for builds of the course's own packages, made in boxes and shown to boxes only as needed."""
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
    """Make a folder for this process alone, to use instead of an unsafe one. It is removed when the process ends."""
    del folder
    made, owner = fresh_folder("workspace-builds-"), os.getpid()

    @atexit.register
    def remove() -> None:
        if os.getpid() == owner:  # not in a forked process, which also runs this function when it ends
            shutil.rmtree(made, ignore_errors=True)

    return made


def is_ones_own(folder: Path) -> bool:
    """Return True if only this user may write to a folder."""
    found = folder.lstat()
    own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    return own and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def is_complete(key: str, base: Path) -> bool:
    """Return True if a finished entry exists, without waiting for a process that may be making it."""
    return _is_of(key, base / key / _MARKER)


def _is_of(key: str, marker: Path) -> bool:
    """Return True if the marker was written for a build with this key, not for one whose folder was renamed later."""
    try:
        return marker.read_text(encoding="utf-8") == key
    except (OSError, UnicodeDecodeError):
        return False


@contextlib.contextmanager
def entry(key: str, base: Path, cancelled: Callable[[], bool] = lambda: False) -> Iterator[CachedBuild]:
    """Hold the entry of a key, so that no other process builds it at the same time.

    If the entry is not finished, the caller gets it empty. It is removed again unless the caller finishes it.

    Args:
        key: The key of the build.
        base: The folder of the cache.
        cancelled: Called from time to time while another process holds the entry. If it returns True, waiting ends.

    Raises:
        GivenUp: The caller no longer needs the entry.
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
    """Hold the lock file of a cache entry.

    The previous holder may have removed the entry together with this lock file. If so, make a new lock file and lock
    that one.
    """
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
    """Take a lock as soon as no other process has it.

    Args:
        lock: A descriptor of the locked file; closing it releases the lock.
        cancelled: Called from time to time. If it returns True, waiting ends.

    Raises:
        GivenUp: The caller no longer needs the lock.
    """
    while True:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            # No event reports that a lock has become free, so this polls.
            if cancelled():
                raise GivenUp("nobody waits for the entry any more") from None
            time.sleep(ASK_EVERY)
        else:
            return


def make_room(base: Path, limit: int = LIMIT, in_use: float = IN_USE) -> list[str]:
    """Remove the least recently used entries until all entries together have at most ``limit`` bytes.

    Leftovers of failed or killed builds are removed, too.

    Args:
        base: The folder of the cache.
        limit: The maximum size in bytes.
        in_use: Seconds for which an entry is kept after its last use.

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
    """Remove an entry that was last used at this time (None: unfinished). Return False if it is in use or was since."""
    file = base / f"{folder.name}.lock"
    with file.open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False  # another process is using it
        if not _is_at(lock, file) or _last_use(folder) != used:
            return False  # another process has just removed, made or used it
        # Remove the marker first: without it the entry does not count, even if removing the rest fails.
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
            with contextlib.suppress(FileNotFoundError):  # another worker may be removing this file
                size += BLOCK + Path(root_, name).lstat().st_size
    return size
