"""Reads, writes and makes files and folders so that no other user and no student's program can interfere.

* A file to read may have been replaced by a link, a pipe or a device: :func:`opened` refuses these.
* A file to write is never incomplete, even after a power cut: :func:`write_whole`.
* On a machine with several users, any user may create something at a path in ``/tmp`` that can be guessed. So each
  temporary folder has a random name, and only the user who makes it can look into it. All temporary folders and files
  of this package are made here: the linter forbids ``tempfile`` everywhere else.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import secrets
import shutil
import stat
import tempfile  # noqa: TID251  (here the folders are made)
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Self

import platformdirs
import re2

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping


def opened(path: str | Path, folder: int | None = None) -> IO[bytes]:
    """Open a regular file for reading. If the path is a link, a pipe or a device, raise an error at once.

    Args:
        path: The path of the file. Links in its folders are followed. If other users can write to its folder, pass a
            descriptor of that folder as well, such as one from os.fwalk.
        folder: A descriptor of the folder to which the path is relative.

    Raises:
        OSError: The path is not a regular file, or cannot be opened.
    """
    flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    descriptor = os.open(path, flags, dir_fd=folder)
    if stat.S_ISREG(os.fstat(descriptor).st_mode):
        return os.fdopen(descriptor, "rb")
    os.close(descriptor)
    raise OSError(errno.EINVAL, "not a regular file")


def name_as_text(name: str) -> str:
    """Return a file name as text that can be encoded and searched. A name on a disk may contain any bytes."""
    return name.encode("utf-8", "replace").decode()


def write_whole(path: Path, data: bytes, mode: int = 0o666) -> None:
    """Write a file so that it is never incomplete, and survives a power cut once this function returns.

    Args:
        mode: The permissions of the file, from which the process's umask is taken.

    Raises:
        OSError: The file could not be written. Its earlier content is then unchanged.
    """
    changed = [path.parent, *(one.parent for one in path.parents if not one.exists())]
    path.parent.mkdir(parents=True, exist_ok=True)
    # The name is random, because in a folder like /tmp another user could create a link at a name that can be
    # guessed.
    beside = path.with_name(f".{path.name}.{secrets.randbelow(10**12)}.new")
    try:
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
        raise
    for folder in changed:
        _keep_names(folder)


def keep_whole(beside: Path, path: Path) -> None:
    """Rename a file that was written next to ``path`` to ``path``, once the disk has stored all of it.

    Raises:
        OSError: The file could not be written.
    """
    with beside.open("rb+") as file:
        os.fsync(file.fileno())
    beside.replace(path)
    _keep_names(path.parent)


def files_below(folder: Path) -> Iterator[Path]:
    """Yield all accessible files and links below a folder, at any depth."""
    folders = [folder]  # os.walk and Path.rglob fail at a depth of a thousand
    while folders:
        with contextlib.suppress(OSError), os.scandir(folders.pop()) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    folders.append(Path(entry))
                else:
                    yield Path(entry)


def remove_unfinished(folder: Path) -> None:
    """Remove files below a folder that killed processes left unfinished. No other process may be using the folder."""
    unfinished = re2.compile(r"\..+\.\d+\.new")
    for file in files_below(folder):
        if unfinished.fullmatch(name_as_text(file.name)):
            with contextlib.suppress(OSError):
                file.unlink()


def _keep_names(folder: Path) -> None:
    """Make the disk store the names in a folder. Some network file systems cannot do that."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with contextlib.suppress(OSError):
            os.fsync(descriptor)
    finally:
        os.close(descriptor)


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
    folder = Path(tempfile.mkdtemp(prefix=prefix, dir=parent or _temporary_files()))
    if parent is not None:
        return folder
    found, of_others = folder.lstat(), stat.S_IRWXG | stat.S_IRWXO
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & of_others:
        raise UnsafeTemporaryFolder(
            f"other users can change {folder}, which was just created: set TMPDIR to a folder of your own"
        )
    return folder


def unnamed_file(parent: Path | None = None) -> IO[bytes]:
    """Open a temporary file without a name. It disappears when it is closed.

    Args:
        parent: A folder of this user; None for the folder for temporary files.
    """
    return tempfile.TemporaryFile(dir=parent or _temporary_files())


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

    def _make_writable(function: Callable[[str], Any], name: str, _: Any) -> None:
        path = Path(name)
        with contextlib.suppress(OSError):
            # Change rights only inside the folder, because its parent is shared.
            for place in (path.parent, path):
                if place.is_relative_to(folder) and not place.is_symlink():
                    place.chmod(stat.S_IRWXU)
            function(name)

    shutil.rmtree(folder, onerror=_make_writable)


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
                _temporary_files()  # raises an error if the folder for temporary files itself does not exist
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
    for folder in _temporary_files().glob(f"{prefix}*"):
        with contextlib.suppress(OSError), _locked(folder):
            remove_tree(folder)


def _temporary_files() -> Path:
    """Return the folder for temporary files; if other users could replace files in it, a folder of this user alone.

    Raises:
        UnsafeTemporaryFolder: No safe folder exists.
    """
    usual = Path(tempfile.gettempdir())
    if _is_safe(usual):
        return usual
    session = os.environ.get("XDG_RUNTIME_DIR")
    own = Path(session) if session else platformdirs.user_cache_path("ros2-course")
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
