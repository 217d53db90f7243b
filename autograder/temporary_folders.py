"""The only way in which this package makes temporary folders and files.

The linter forbids ``tempfile`` everywhere else. On a machine with several users, any user may create something at
a path in ``/tmp`` that can be guessed. So each name is random, and only the user who makes a folder can look into it.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import stat
import tempfile  # noqa: TID251  (here the folders are made)
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Self

import platformdirs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

_NAME = "ros2-course"
_OF_OTHERS = stat.S_IRWXG | stat.S_IRWXO


class UnsafeTemporaryFolder(PermissionError):
    """Other users could replace files in the folder for temporary files. The message says what to do."""


def fresh_folder(prefix: str, parent: Path | None = None) -> Path:
    """Make a folder that only this user can read, and return it. The caller has to remove it.

    Args:
        prefix: The beginning of the name. Keep it short if the folder will contain Unix sockets.
        parent: A folder of this user; None for the folder for temporary files.

    Raises:
        UnsafeTemporaryFolder: No safe folder for temporary files exists, or another user can change the new folder.
    """
    folder = Path(tempfile.mkdtemp(prefix=prefix, dir=parent or _base()))
    if parent is not None:
        return folder
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & _OF_OTHERS:
        raise UnsafeTemporaryFolder(
            f"other users can change {folder}, which was just created: set TMPDIR to a folder of your own"
        )
    return folder


def unnamed_file(parent: Path | None = None) -> IO[bytes]:
    """Open a temporary file without a name. It disappears when it is closed.

    Args:
        parent: A folder of this user; None for the folder for temporary files.
    """
    return tempfile.TemporaryFile(dir=parent or _base())


@contextlib.contextmanager
def scratch_folder(parent: Path, prefix: str = "n") -> Iterator[Path]:
    """Make a folder in ``parent`` that only this user can read, and remove it at the end of the block.

    Args:
        parent: A folder, which is created if it does not exist. Keep its path short if Unix sockets will be below it.
        prefix: The beginning of the name.
    """
    parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    folder = fresh_folder(prefix, parent)
    try:
        yield folder
    finally:
        remove_tree(folder)


def write_files(files: Mapping[str, bytes], folder: Path) -> Path:
    """Create a folder, and write files into it by their relative paths. Return the folder."""
    folder.mkdir()
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return folder


def remove_tree(folder: Path) -> None:
    """Remove a folder, even if its files and folders are write-protected."""

    def make_writable(function: Callable[[str], Any], name: str, _: Any) -> None:
        path = Path(name)
        with contextlib.suppress(OSError):
            # Change rights only inside the folder, because its parent is shared.
            for place in (path.parent, path):
                if place.is_relative_to(folder) and not place.is_symlink():
                    place.chmod(stat.S_IRWXU)
            function(name)

    shutil.rmtree(folder, onerror=make_writable)


class HeldFolder:
    """A new private folder for temporary files. Folders left by killed processes are removed first.

    A killed process cannot remove its folder, so the next process that makes a folder of this kind does so. A lock on
    the folder shows whether its creator is alive; the system releases the lock when a process ends, however it ends.

    Args:
        prefix: The beginning of the names of all folders of this kind. Folders of this user with this prefix are
            removed, so no other program may use it.

    Attributes:
        path: The path of the folder.
    """

    def __init__(self, prefix: str) -> None:
        sweep(prefix)
        while True:
            # Before the new folder is locked, another process may take it for an abandoned one and remove it. In that
            # case, make another folder.
            try:
                self.path = fresh_folder(prefix)
                self._lock = os.open(self.path, os.O_RDONLY | os.O_DIRECTORY)
            except FileNotFoundError:
                _base()  # raises an error if the folder for temporary files itself does not exist
                continue
            fcntl.flock(self._lock, fcntl.LOCK_EX)
            if self.path.exists():
                return
            os.close(self._lock)

    def remove(self) -> None:
        """Remove the folder and its content. This may be called twice."""
        if self._lock >= 0:
            remove_tree(self.path)
            os.close(self._lock)
            self._lock = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.remove()


def sweep(prefix: str) -> None:
    """Remove the folders with this prefix whose creators were killed."""
    for folder in _base().glob(f"{prefix}*"):
        with contextlib.suppress(OSError), _locked(folder):
            remove_tree(folder)


def _base() -> Path:
    """Return the folder for temporary files; if other users could replace files in it, a folder of this user alone.

    Raises:
        UnsafeTemporaryFolder: No safe folder exists.
    """
    usual = Path(tempfile.gettempdir())
    if _is_safe(usual):
        return usual
    session = os.environ.get("XDG_RUNTIME_DIR")
    own = Path(session) if session else platformdirs.user_cache_path(_NAME)
    with contextlib.suppress(OSError):
        own.mkdir(mode=0o700, parents=True, exist_ok=True)
        if _is_safe(own):
            return own
    raise UnsafeTemporaryFolder(
        f"every user can replace files in {usual}: set TMPDIR to a folder of your own, "
        f"or correct the folder's permissions: chmod 1777 {usual}"
    )


def _is_safe(folder: Path) -> bool:
    mode = folder.stat().st_mode
    return bool(mode & stat.S_ISVTX) or not mode & stat.S_IWOTH


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Hold the lock of one of this user's folders.

    Raises:
        OSError: Another process holds the lock, or the folder belongs to another user or is not a folder.
    """
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        if os.fstat(descriptor).st_uid != os.getuid():
            raise PermissionError(f"{folder} belongs to another user")
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    finally:
        os.close(descriptor)
