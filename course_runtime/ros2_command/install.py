"""Puts `ros2`, `launch` and `launch_ros` into a virtual environment. A real installation takes precedence.

The set-up calls `install` once; a second call changes nothing. A real installation is never hidden:

* the program `ros2` starts the `ros2` of the ROS installation in use, if there is one (`real_installation`);
* `launch` is found by a finder that asks all other finders first, so any installed `launch` takes precedence,
  wherever it is in the search path. A folder without `__init__.py` does not count, because a package keeps its launch
  files in such a folder, and `colcon build --symlink-install` puts it into the search path.
"""

from __future__ import annotations

import stat
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
LAUNCH_FRONT = ROOT / "course_runtime" / "launch_front"

_HOOK = "course_launch_front"
_PTH = f"{_HOOK}.pth"
_LONGEST_SHEBANG = 120  # bytes: older kernels cut a first line that is longer

_PROGRAM = '''\
"""The course's own ros2 (course_runtime.ros2_command). A real one, where there is one, runs instead."""

import os
import signal
import sys

# Ctrl-C while the command is still being loaded ends it without a traceback, with the exit code of every Ctrl-C.
heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
if heard:
    signal.signal(signal.SIGINT, lambda *_: os._exit(2))
sys.path.insert(0, {root!r})
from course_runtime.ros2_command.main import main

sys.path.remove({root!r})
if heard:
    signal.signal(signal.SIGINT, signal.default_int_handler)
sys.exit(main())
'''

_HOOK_CODE = '''\
"""Find the course's own launch packages when no other ones are installed."""

import sys

_FOLDER = {folder!r}
_PACKAGES = ("launch", "launch_ros", "launch_xml", "launch_yaml")


def _installed(name):
    """Return the path of an installed package; a mere folder of that name does not count."""
    finders = [finder for finder in sys.meta_path if finder is not _UnlessInstalled]
    specs = (finder.find_spec(name, None) for finder in finders if hasattr(finder, "find_spec"))
    return next((spec for spec in specs if spec is not None and spec.origin is not None), None)


class _UnlessInstalled:
    """A finder that comes first, because PathFinder takes a folder for a package if no real one exists."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        if path is not None or name not in _PACKAGES:
            return None
        from importlib.machinery import PathFinder

        real = _installed("launch")
        if real is None:
            return PathFinder.find_spec(name, [_FOLDER])
        # Parts of a real launch and of this one do not fit together.
        return real if name == "launch" else _installed(name)


def begin():
    """Add the finder, before all others."""
    sys.meta_path.insert(0, _UnlessInstalled)
'''


def _shebang(python: Path) -> str:
    """Return the first lines of a program that this Python will run."""
    line = f"#!{python}"
    if " " not in line and len(line.encode()) <= _LONGEST_SHEBANG:
        return f"{line}\n"
    # For a path that the kernel cannot use, a shell starts Python, which reads these lines as a string.
    return f"#!/bin/sh\n'''exec' \"{python}\" \"$0\" \"$@\"\n' '''\n"


def _write(path: Path, text: str, *, executable: bool = False) -> None:
    """Write a file, unless it already has this text."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
    if executable:
        path.chmod(path.stat().st_mode | stat.S_IXUSR | stat.S_IXGRP | stat.S_IXOTH)


def _site_packages(venv: Path) -> Path:
    """Return the folder for packages of a virtual environment.

    Raises:
        FileNotFoundError: The folder is not a virtual environment.
    """
    found = sorted(venv.glob("lib/python3*/site-packages"))
    if not found:
        raise FileNotFoundError(f"{venv} is not a virtual environment: it has no lib/python3*/site-packages")
    return found[-1]


def install(venv: Path) -> None:
    """Make `ros2` a program of a virtual environment, and `launch` and `launch_ros` importable in it.

    Args:
        venv: The folder of the virtual environment.

    Raises:
        FileNotFoundError: The folder is not a virtual environment.
    """
    packages = _site_packages(venv)
    _write(packages / f"{_HOOK}.py", _HOOK_CODE.format(folder=str(LAUNCH_FRONT)))
    _write(packages / _PTH, f"import {_HOOK}; {_HOOK}.begin()\n")
    program = _shebang(venv.absolute() / "bin" / "python") + _PROGRAM.format(root=str(ROOT))
    _write(venv / "bin" / "ros2", program, executable=True)
