"""Uses the course in a Jupyter kernel that was started without it, as in Colab: sets up ``.venv``, then joins it.

The first cell of each notebook calls `set_up` where ``autograder`` cannot be imported
(``autograder/masters/source_notebooks.py`` writes that cell). The environment is the one that ``./course setup`` makes,
with the same locks and repairs, so a verdict is the same one as in ``./course lab``.

A running kernel cannot start again with another ``LD_LIBRARY_PATH``, as each Python of ``.venv`` does. So `join`
loads the libraries of ROS itself: the loader finds a library that is loaded already by its name.

This module can be imported by a Python that is too old for the course, to say so.
"""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

ROOT = Path(__file__).resolve().parent.parent
OLDEST = (3, 11)
"""The oldest version of Python on which the course runs."""
_OPENED_BY_NAME = ("librmw_*.so", "lib*__rosidl_*.so")
"""The libraries that ROS opens by name while it runs: the middleware and the types of messages."""
_SITES = ("site-packages", "dist-packages")


class NotSetUp(Exception):
    """The course cannot be set up here. The message says why and what to do."""

    def _render_traceback_(self) -> list[str]:
        """Return what IPython shows below the cell: the message, without the lines of this file."""
        return [str(self)]


def set_up(root: Path = ROOT) -> None:
    """Set the course up if necessary, and let this kernel use it.

    Args:
        root: The folder of the course.

    Raises:
        NotSetUp: It could not be set up, or this kernel cannot use it.
    """
    if sys.version_info[:2] < OLDEST:
        raise NotSetUp(
            f"The course needs Python 3.11 to 3.14, and this kernel is Python {sys.version.split()[0]}. "
            "Choose another kernel."
        )
    run_set_up(root)
    join(root)


def run_set_up(root: Path) -> None:
    """Run ``./course setup`` with the Python of this kernel, and show its output.

    An existing environment stays unchanged, even if another Python made it.

    Raises:
        NotSetUp: The set-up failed.
    """
    base = getattr(sys, "_base_executable", sys.executable)  # noqa: TID251  (this runs before the course is there)
    python = {} if (root / ".venv" / "bin" / "python").exists() else {"PYTHON": base}
    process = subprocess.Popen(
        ["sh", str(root / "course"), "setup"],
        env={**os.environ, **python},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    )
    assert process.stdout is not None
    with process:
        for line in process.stdout:
            print(line, end="", flush=True)
    if process.returncode != 0:
        raise NotSetUp("The course is not set up: the lines above say why. Then run this cell again.")


def join(root: Path) -> None:
    """Let this process import and start what is installed in the course's environment.

    Raises:
        NotSetUp: The environment was made with another Python.
    """
    prefix = root / ".venv"
    major, minor = sys.version_info[:2]
    site_packages = prefix / "lib" / f"python{major}.{minor}" / "site-packages"
    if not (site_packages / "course_process.py").is_file():
        raise NotSetUp(
            f"The course in {root} was not set up with Python {major}.{minor}, which this kernel is. Choose the "
            f"kernel of {prefix}, or delete that folder and run this cell again: then it is set up with this Python."
        )
    _import_from(site_packages, root)
    import course_process  # the one in site-packages, which knows the paths of this machine

    from course_runtime.jupyter_files import KERNEL_VARIABLES

    course_process.join()
    os.environ.update(KERNEL_VARIABLES)
    ours = os.environ["LD_LIBRARY_PATH"].split(os.pathsep)
    folders = [Path(folder) for folder in ours if folder.startswith(f"{prefix}/")]
    by_name = [file for pattern in _OPENED_BY_NAME for file in sorted((prefix / "lib").glob(pattern))]
    modules = [*site_packages.glob("rclpy/*.so"), *site_packages.glob("*/*__rosidl_*.so")]
    load_libraries([*sorted(modules), *by_name], folders)
    # The judge, and a student's programs, are started with it.
    sys.executable = str(prefix / "bin" / "python")  # noqa: TID251


def _import_from(site_packages: Path, root: Path) -> None:
    """Add the folders to the search path after Python's own modules and a student's, before other installations."""
    ours = [str(site_packages), str(root)]
    others = [entry for entry in sys.path if entry not in ours]
    first = next((place for place, entry in enumerate(others) if entry.endswith(_SITES)), len(others))
    sys.path[:] = [*others[:first], *ours, *others[first:]]


def load_libraries(files: Iterable[Path], folders: Sequence[Path]) -> None:
    """Load shared libraries, each after those of these folders that it needs.

    The wheels contain copies of libraries, and some libraries end a process that loads two copies. A library that
    needs a missing file is left out: the code that uses it reports this when it is imported.
    """
    for file in files:
        _load(file, folders)


def _load(file: Path, folders: Sequence[Path]) -> bool:
    """Load a library after those that it needs; return False if that cannot be done."""
    before = ""
    while True:
        try:
            ctypes.CDLL(str(file))
        except OSError as error:
            missing = str(error).partition(":")[0]  # the loader names the file that it did not find
            found = next((folder / missing for folder in folders if (folder / missing).is_file()), None)
            if missing == before or found is None or not _load(found, folders):
                return False
            before = missing
        else:
            return True
