"""A cache of builds: one folder (entry) for each build, named by the build's key. Each user has a separate cache.

A build is made at its final path, because files in an install folder contain that path. While it is made, the entry is
locked, and at the end, a marker file is written. So an entry without a marker is an interrupted build, which is removed
and made again. The process that makes a build may be killed, for example if JupyterLab restarts the kernel. The build
then ends as well, and the lock is released once no process of the build can write any more.
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

from autograder.safe_files import fresh_folder
from autograder.workspaces.builds.build_artifacts import BLOCK

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


VARIABLE = "AUTOGRADER_WORKSPACE_CACHE"
"""The environment variable that contains the path of the cache. The grader sets a separate cache for each box."""
LIMIT = 1_000_000_000
"""The maximum size in bytes of all entries together; one interface package takes two million."""
IN_USE = 900.0
"""Seconds for which an entry is kept after its last use, because programs of the build may still run."""
ASK_EVERY = 0.1
"""Seconds between two attempts to lock an entry that another process has locked."""
_MARKER = "complete"
_NAME = "ros2-on-the-wire"


class GivenUp(RuntimeError):
    """The caller has stopped waiting for an entry."""


@dataclass(frozen=True)
class CachedBuild:
    """A folder of the cache, locked while the caller uses it.

    Attributes:
        folder: The path of the folder.
        complete: True if the entry contains a finished build.
        lock: The descriptor of the locked file. Every process that writes into the folder inherits it.
    """

    folder: Path
    complete: bool
    lock: int

    def finish(self) -> None:
        """Mark the build as finished, so that it is kept and used again."""
        (self.folder / _MARKER).write_text(self.folder.name, encoding="utf-8")


def root() -> Path:
    """Return the folder of the cache.

    Programs in the cache are run, so the folder must belong to this user, and no other user may write to it. Otherwise
    a new, empty temporary folder is used instead.
    """
    named = os.environ.get(VARIABLE)
    return _own(Path(named) if named else platformdirs.user_cache_path(_NAME) / "workspaces")


def graders_root() -> Path:
    """Return the folder for the grader's builds of the course's packages. A box sees only the builds that it needs."""
    return _own(platformdirs.user_cache_path(_NAME) / "graded-builds")


def _own(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        if _is_ones_own(folder):
            return folder
    except OSError:
        pass
    return _in_place_of(folder)


@functools.cache
def _in_place_of(folder: Path) -> Path:
    """Make a temporary folder, which is used instead of an unsafe one and removed when this process ends."""
    del folder
    made, owner = fresh_folder("workspace-builds-"), os.getpid()

    @atexit.register
    def remove() -> None:
        if os.getpid() == owner:  # a forked child runs this function, too, but must not remove the folder
            shutil.rmtree(made, ignore_errors=True)

    return made


def _is_ones_own(folder: Path) -> bool:
    """Return True if only this user may write to a folder."""
    found = folder.lstat()
    own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    return own and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def is_complete(key: str, base: Path) -> bool:
    """Return True if the cache contains a finished build with this key, and do not wait for an unfinished one."""
    return _is_of(key, base / key / _MARKER)


def _is_of(key: str, marker: Path) -> bool:
    """Return True if a marker file contains this key. The marker of a renamed folder contains another key."""
    try:
        return marker.read_text(encoding="utf-8") == key
    except (OSError, UnicodeDecodeError):
        return False


@contextlib.contextmanager
def entry(key: str, base: Path, cancelled: Callable[[], bool] = lambda: False) -> Iterator[CachedBuild]:
    """Lock the entry with a key during a ``with`` block, so that no other process makes this build at the same time.

    If the entry has no finished build, it is an empty folder, in which the caller makes the build. At the end of the
    block, the entry is removed unless the caller has called :meth:`CachedBuild.finish`.

    Args:
        base: The folder of the cache.
        cancelled: Called from time to time while another process holds the entry. If it returns True, waiting ends.

    Raises:
        GivenUp: The caller no longer needs the entry.
    """
    with _turn(base / f"{key}.lock", cancelled) as lock:
        folder = base / key
        marker = folder / _MARKER
        complete = _is_of(key, marker) and _is_ones_own(folder)
        if complete:
            # make_room takes this time for the time of the last use.
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
    """Hold a lock on the lock file of an entry.

    If another process has removed the entry and the lock file while this process waited, a new lock file is locked.
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
    """Wait until no other process has locked a file, and lock it.

    Args:
        lock: A descriptor of the file; closing it releases the lock.
        cancelled: Called from time to time. If it returns True, waiting ends.

    Raises:
        GivenUp: The caller no longer needs the lock.
    """
    while True:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            # Try to lock again and again, because waiting inside flock could not be canceled.
            if cancelled():
                raise GivenUp("no process waits for the entry any more") from None
            time.sleep(ASK_EVERY)
        else:
            return


def make_room(base: Path, limit: int = LIMIT, in_use: float = IN_USE) -> list[str]:
    """Remove the least recently used entries until all entries together have at most ``limit`` bytes.

    Entries of failed or killed builds are removed, too.

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
        # The entries are sorted by their last use: if this one is in use, so are all after it.
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
    """Remove an entry, unless it is locked or was used after the time ``used``. Return True if it was removed.

    An entry without a finished build has no time of last use: ``used`` is None.
    """
    file = base / f"{folder.name}.lock"
    with file.open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False  # another process has locked the entry
        if not _is_at(lock, file) or _last_use(folder) != used:
            return False  # another process has just removed, made or used the entry

        # Remove the marker of a complete build first, so that the entry counts as an interrupted build if the removal
        # of the other files fails.
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
            # Another thread or process may be removing this file.
            with contextlib.suppress(FileNotFoundError):
                size += BLOCK + Path(root_, name).lstat().st_size
    return size
