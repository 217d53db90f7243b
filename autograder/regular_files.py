"""Files that somebody else has made, who may have put anything in their place."""

from __future__ import annotations

import errno
import os
import stat
from typing import IO, TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


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
