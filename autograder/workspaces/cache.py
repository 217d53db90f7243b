"""A cache of builds: one folder a build, named by the key of its sources, that only its owner may use.

An entry is built in place (an install folder names its own path) under a lock, and counts only once its marker is
written: whatever was interrupted is removed and done again. Where the one who builds is killed, as a kernel is when
JupyterLab restarts it, the build is ended too, and has the lock until nothing of it is left that could write.
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
"""Names another folder for the cache; a grader gives each box its own."""
LIMIT = 1_000_000_000
"""Bytes that all entries may take together; one interface package takes two million."""
IN_USE = 900.0
"""Seconds after its last use in which an entry is not removed: its programs may still run, as long as a check lasts."""
ASK_EVERY = 0.1
"""Seconds between two looks whether an entry is free, for those who may give up."""
_MARKER = "complete"
_NAME = "ros2-course-autograder"


class GivenUp(RuntimeError):
    """The entry is not needed any more: whoever asked for it has given up."""


@dataclass(frozen=True)
class Entry:
    """A folder of the cache, locked by whoever holds it.

    Attributes:
        folder: Where it is.
        complete: Whether a build is there already.
        lock: The descriptor of its lock, which whatever else writes into the folder holds, too.
    """

    folder: Path
    complete: bool
    lock: int

    def finish(self) -> None:
        """Let the build count from now on."""
        (self.folder / _MARKER).write_text(self.folder.name, encoding="utf-8")


def root() -> Path:
    """The folder of the cache, owned by this user and closed to all others.

    A folder that somebody else owns or may write to is not used: its builds would be run. A fresh one in the
    temporary folder takes its place, so that the work goes on without a cache.
    """
    named = os.environ.get(VARIABLE)
    return _own(Path(named) if named else platformdirs.user_cache_path(_NAME) / "workspaces")


def graders_root() -> Path:
    """The folder of the builds of the course's own packages: made in boxes, and seen by a box only as far as needed."""
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
    """A folder for this process alone, and for as long as it lives."""
    del folder
    made, owner = fresh_folder("workspace-builds-"), os.getpid()

    @atexit.register
    def remove() -> None:
        if os.getpid() == owner:  # and no fork of it, which ends, too
            shutil.rmtree(made, ignore_errors=True)

    return made


def is_ones_own(folder: Path) -> bool:
    """True if only this user may write to a folder."""
    found = folder.lstat()
    own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    return own and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def is_complete(key: str, base: Path) -> bool:
    """True if there is a finished entry, without waiting for anybody who makes it."""
    return _is_of(key, base / key / _MARKER)


def _is_of(key: str, marker: Path) -> bool:
    """True if the marker was written for a build of this key, and not for one whose folder has another name since."""
    try:
        return marker.read_text(encoding="utf-8") == key
    except (OSError, UnicodeDecodeError):
        return False


@contextlib.contextmanager
def entry(key: str, base: Path, cancelled: Callable[[], bool] = lambda: False) -> Iterator[Entry]:
    """Hold the entry of a key: nobody else builds it at the same time.

    An entry that was not finished is empty when it is handed over, and is removed when it is not finished
    then.

    Args:
        key: Says what is in it.
        base: The cache.
        cancelled: Asked now and then, while somebody else has the entry, whether it is still wanted.

    Raises:
        GivenUp: It is not.
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
            yield Entry(folder, complete, lock.fileno())
        finally:
            if not marker.is_file():
                shutil.rmtree(folder, ignore_errors=True)
    if not complete:
        make_room(base)


@contextlib.contextmanager
def _turn(file: Path, cancelled: Callable[[], bool]) -> Iterator[IO[str]]:
    """Hold a lock. Whoever had it may have removed it with its entry: then another one counts, which is new."""
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
    """Take a lock once nobody else has it.

    Args:
        lock: A descriptor of what is locked; whoever closes it gives the lock back.
        cancelled: Asked now and then whether it is still wanted.

    Raises:
        GivenUp: It is not.
    """
    while True:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            # A lock has no event that one could wait for together with anything else.
            if cancelled():
                raise GivenUp("nobody waits for the entry any more") from None
            time.sleep(ASK_EVERY)
        else:
            return


def make_room(base: Path, limit: int = LIMIT, in_use: float = IN_USE) -> list[str]:
    """Remove the entries that were not used for longest, until all together take at most ``limit`` bytes.

    What builds that failed or were killed have left goes, too.

    Args:
        base: The cache.
        limit: Bytes.
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
    """Remove an entry that was used last then, or never finished; False where somebody uses it, or has since."""
    file = base / f"{folder.name}.lock"
    with file.open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False  # somebody uses it
        if not _is_at(lock, file) or _last_use(folder) != used:
            return False  # somebody else has removed it just now, or made it or used it
        # Without its marker it does not count, should the rest stay behind.
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
    """The bytes that a folder and all in it take of a disk, about."""
    size = 0
    for root_, _, names in os.walk(folder):
        size += BLOCK
        for name in names:
            with contextlib.suppress(FileNotFoundError):  # another worker may be removing it
                size += BLOCK + Path(root_, name).lstat().st_size
    return size
