"""A folder for one submission that is gone afterwards, whatever was done in it."""

from __future__ import annotations

import contextlib
import shutil
import stat
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
