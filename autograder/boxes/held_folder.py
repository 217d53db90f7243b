"""A folder among the temporary files that does not outlive its maker for long, also where that is killed.

Nobody who is killed can tidy up, whatever moment it is: so the next one who needs such a folder does it. A lock on the
folder says whether its maker lives; the system gives it back when a process ends, in whatever way.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Self

from autograder.boxes.scratch import remove_tree

if TYPE_CHECKING:
    from collections.abc import Iterator


class HeldFolder:
    """A fresh folder that only we can read; those of killed makers are removed first.

    Args:
        prefix: How the names of all folders of this kind begin.

    Attributes:
        path: Where it is.
    """

    def __init__(self, prefix: str) -> None:
        _sweep(prefix)
        while True:
            self.path = Path(tempfile.mkdtemp(prefix=prefix))
            try:
                self._lock = os.open(self.path, os.O_RDONLY | os.O_DIRECTORY)
            except FileNotFoundError:
                continue
            fcntl.flock(self._lock, fcntl.LOCK_EX)
            # Before it was locked, another process may have removed it as one that was left behind.
            if self.path.exists():
                return
            os.close(self._lock)

    def remove(self) -> None:
        """Remove it with what is in it; may be called twice."""
        if self._lock >= 0:
            remove_tree(self.path)
            os.close(self._lock)
            self._lock = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.remove()


def _sweep(prefix: str) -> None:
    for folder in Path(tempfile.gettempdir()).glob(f"{prefix}*"):
        with contextlib.suppress(OSError), _locked(folder):
            remove_tree(folder)


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder of ours.

    Raises:
        OSError: Somebody else holds it, or the folder is not ours, or no folder.
    """
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        if os.fstat(descriptor).st_uid != os.getuid():
            raise PermissionError(f"{folder} is somebody else's")
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    finally:
        os.close(descriptor)
