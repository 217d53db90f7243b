"""Regular files: others' opened, who may have put anything in their place, and own ones written in one step."""

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
    """A regular file, open for reading: no link is followed to it, and no pipe or device is waited for.

    Args:
        path: Where it is. Links on the way to it are followed: name a file of a folder that others can write to by that
            folder's descriptor, as os.fwalk gives them.
        folder: A descriptor of the folder that the path is relative to.

    Raises:
        OSError: It is something else, or cannot be opened.
    """
    flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    descriptor = os.open(path, flags, dir_fd=folder)
    if stat.S_ISREG(os.fstat(descriptor).st_mode):
        return os.fdopen(descriptor, "rb")
    os.close(descriptor)
    raise OSError(errno.EINVAL, "not a regular file")


def name_as_text(name: str) -> str:
    """The name of a file as a text that can be written and searched: on a disk it may be bytes that no text has."""
    return name.encode("utf-8", "replace").decode()


def write_whole(path: Path, data: bytes) -> None:
    """Write a file so that it is never there in part, and still there after a power cut when this returns.

    Raises:
        OSError: It could not be written; then what was there before still is.
    """
    changed = [path.parent, *(one.parent for one in path.parents if not one.exists())]
    path.parent.mkdir(parents=True, exist_ok=True)
    # In a folder like /tmp another user could put a link at a name that can be guessed.
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
    """Give a file that was written beside ``path`` that name, once the disk has all of it.

    Raises:
        OSError: It could not be written.
    """
    with beside.open("rb+") as file:
        os.fsync(file.fileno())
    beside.replace(path)
    _keep_names(path.parent)


def files_below(folder: Path) -> Iterator[Path]:
    """All files and links below a folder, as far as they can be looked at, however many folders are in each other."""
    folders = [folder]  # os.walk and Path.rglob do not come back from a thousand
    while folders:
        with contextlib.suppress(OSError), os.scandir(folders.pop()) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    folders.append(Path(entry))
                else:
                    yield Path(entry)


def remove_unfinished(folder: Path) -> None:
    """Remove what killed processes had begun to write below a folder, in which nobody else is at work."""
    for file in files_below(folder):
        if _UNFINISHED.fullmatch(name_as_text(file.name)):
            with contextlib.suppress(OSError):
                file.unlink()


def _keep_names(folder: Path) -> None:
    """Have the disk know the names in a folder; some file systems of a network cannot be told to."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with contextlib.suppress(OSError):
            os.fsync(descriptor)
    finally:
        os.close(descriptor)
