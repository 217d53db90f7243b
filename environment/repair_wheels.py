"""Repair the ROS wheels' CMake files, so that packages can be built against them.

The wheels were built in a container. What CMake exports for the Python part of a message package names that
container's folders, ``/opt/python/cp311-cp311/include/python3.11`` and numpy's headers below it, and CMake
stops with "non-existent path in its INTERFACE_INCLUDE_DIRECTORIES". Here they are pointed at this
interpreter's.

Run by the Python of the environment: ``.venv/bin/python -m environment.repair_wheels``. Running it again
changes nothing.
"""

from __future__ import annotations

import re
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

from environment.replacing import replace_content

_BUILD_PYTHON = r"/opt/python/cp\d+-cp\d+t?"
_PYTHON_INCLUDE = re.compile(_BUILD_PYTHON + r"/include/python3\.\d+t?")
_NUMPY_INCLUDE = re.compile(_BUILD_PYTHON + r"/lib/python3\.\d+t?/site-packages/numpy/_?core/include")
_LEFT_OVER = re.compile(r"/opt/python/[^\s\";]+")


class RepairError(Exception):
    """A folder of the build container is named that has no known counterpart, or headers are missing."""


@dataclass(frozen=True)
class HeaderFolders:
    """The folders of this interpreter's headers."""

    python: Path
    numpy: Path

    @classmethod
    def here(cls) -> HeaderFolders:
        """Return those of the interpreter that runs this.

        Raises:
            RepairError: one of them is not installed.
        """
        import numpy

        folders = cls(Path(sysconfig.get_path("include")), Path(numpy.get_include()))
        for header in (folders.python / "Python.h", folders.numpy / "numpy" / "arrayobject.h"):
            if not header.exists():
                raise RepairError(f"The header {header} is missing: install the header files of Python.")
        return folders


def repaired(text: str, headers: HeaderFolders) -> str:
    """Return the text of a CMake file with the container's header folders replaced by this interpreter's.

    Raises:
        RepairError: another folder of the container is named.
    """
    # By a function, for a backslash in a path must not be read as a group.
    text = _NUMPY_INCLUDE.sub(lambda _: headers.numpy.as_posix(), text)
    text = _PYTHON_INCLUDE.sub(lambda _: headers.python.as_posix(), text)
    left_over = _LEFT_OVER.search(text)
    if left_over:
        raise RepairError(f"a folder of the build machine that has no counterpart here: {left_over.group()}")
    return text


def repair(prefix: Path, headers: HeaderFolders) -> list[Path]:
    """Repair every CMake file that the wheels installed below `prefix`, and return those that were changed.

    Each file is replaced in one step: after an interruption, running again goes on from there.

    Raises:
        RepairError: a file names a folder that this program does not know; the message says which file.
    """
    changed = []
    for path in sorted(prefix.glob("share/*/cmake/**/*.cmake")):
        # The bytes outside the two paths are left alone, whatever their encoding.
        text = path.read_bytes().decode("utf-8", "surrogateescape")
        try:
            new = repaired(text, headers)
        except RepairError as error:
            raise RepairError(f"{path}: {error}") from None
        if new != text:
            replace_content(path, new.encode("utf-8", "surrogateescape"))
            changed.append(path)
    return changed


def main() -> int:
    """Repair the wheels of the environment whose Python runs this."""
    try:
        changed = repair(Path(sys.prefix), HeaderFolders.here())
    except RepairError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print(f"{len(changed)} CMake files repaired")
    return 0


if __name__ == "__main__":
    sys.exit(main())
