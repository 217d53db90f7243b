"""Folders that are gone afterwards, whatever was done in them, and also where their makers were killed."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import stat
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping


@contextlib.contextmanager
def scratch_folder(parent: Path) -> Iterator[Path]:
    """Make a folder in ``parent`` that only we can read, and remove it at the end.

    Args:
        parent: Made where it is not there. Keep it short: Unix sockets will have their names in it.
    """
    parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(prefix="n", dir=parent))
    try:
        yield folder
    finally:
        remove_tree(folder)


def write_files(files: Mapping[str, bytes], folder: Path) -> Path:
    """Write files by their relative paths into a folder, which is made; returns the folder."""
    folder.mkdir()
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return folder


def remove_tree(folder: Path) -> None:
    """Remove a folder although somebody took away the right to."""

    def make_writable(function: Callable[[str], Any], name: str, _: Any) -> None:
        path = Path(name)
        with contextlib.suppress(OSError):
            # Only inside the folder: the one that holds it belongs to everybody.
            for place in (path.parent, path):
                if place.is_relative_to(folder) and not place.is_symlink():
                    place.chmod(stat.S_IRWXU)
            function(name)

    shutil.rmtree(folder, onerror=make_writable)


class HeldFolder:
    """A fresh folder among the temporary files that only we can read; those of killed makers are removed first.

    Nobody who is killed can tidy up, whatever moment it is: so the next one who needs such a folder does it. A lock on
    the folder says whether its maker lives; the system gives it back when a process ends, in whatever way.

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
