"""Reads files that may have been replaced by a link, pipe or device, and writes files in one step."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import stat
from pathlib import Path
from typing import IO, TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterator

_UNFINISHED = re2.compile(r"\..+\.\d+\.new")


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
    """Return a file name as text that can be encoded and searched, because on a disk it may contain any bytes."""
    return name.encode("utf-8", "replace").decode()


def write_whole(path: Path, data: bytes) -> None:
    """Write a file so that it is never incomplete, and survives a power cut once this function returns.

    Raises:
        OSError: The file could not be written. Its earlier content is then unchanged.
    """
    changed = [path.parent, *(one.parent for one in path.parents if not one.exists())]
    path.parent.mkdir(parents=True, exist_ok=True)
    # The name is random, because in a folder like /tmp another user could create a link at a name that can be
    # guessed.
    beside = path.with_name(f".{path.name}.{secrets.randbelow(10**12)}.new")
    try:
        with beside.open("xb") as file:
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
    for file in files_below(folder):
        if _UNFINISHED.fullmatch(name_as_text(file.name)):
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
