"""Starts every Python of the course's environment so that it finds ROS without sourcing.

The set-up copies this file into the site-packages of ``.venv``, with a ``.pth`` file that calls `begin`, and with the
paths of this machine in ``course_paths.py``. So ``.venv/bin/python talker.py`` works in any terminal, and so does
everything that Python starts. Every start pays for what is done here, so this file imports nothing but ``os`` and
``sys``.

The ROS wheels contain a ``.pth`` file of their own (ros-wheels-bootstrapper), which starts Python a second time with
``LD_LIBRARY_PATH`` set. `begin` runs before that file and takes its place, because that file

* trusts its guard variable, which a process of another environment may have set for its own libraries;
* keeps a sourced ROS of another distribution at the front, so that the wrong rclpy is found;
* adds the library folders in the order of a set, which is different at each start;
* costs each start 10 ms for its imports, even if it has nothing to do.
"""

from __future__ import annotations

import os
import sys

# Spelt out, because importing `typing` or `collections` costs more than all the rest of this file.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, MutableMapping, Sequence

# Variables in which the environment's programs come first, as in every activated environment.
_IN_FRONT = ("PATH",)
# A change of these reaches a running process too late: the loader and the interpreter read them at the start.
READ_AT_START = ("LD_LIBRARY_PATH", "PYTHONPATH", "PYTHONUTF8")
# This variable is set only during a second start, so that no third start follows.
_SECOND_START = "_COURSE_SECOND_START"
_BOOTSTRAPPER = "ros_wheels_bootstrapper"
# The program that a workspace's setup.bash asks what to export. It compares with its own environment, so it must run
# in the terminal's environment; otherwise half of the variables would count as set.
_SETUP_BASH_HELPER = "_local_setup_util"


def holds_rclpy(prefix: str) -> bool:
    """Return True if a folder is the prefix of an installed ROS 2. A workspace on top of one is not."""
    return os.path.exists(f"{prefix}/share/rclpy/package.xml")  # noqa: PTH110 (pathlib costs 10 ms)


def _entries(value: str | None) -> list[str]:
    return [entry for entry in (value or "").split(os.pathsep) if entry]


def _lies_in(path: str, folders: Sequence[str]) -> bool:
    return any(path == folder or path.startswith(f"{folder}/") for folder in folders)


def variables(
    paths: Mapping[str, Sequence[str]], values: Mapping[str, str], environ: Mapping[str, str]
) -> dict[str, str]:
    """Return the variables that have to change in a process of the course, with their new values.

    A folder that is already in a search path keeps its position, so that a student's sourced workspace stays before
    ROS. Folders of a ROS other than the one of this environment are dropped, because two in one process never work.
    ``PATH`` keeps them, because a folder of programs is searched only if nothing before it fits.

    Args:
        paths: The folders that must be in each search path variable.
        values: The variables that have a single value.
        environ: The current variables of the process.
    """
    ours = paths.get("AMENT_PREFIX_PATH", ())
    prefixes = _entries(environ.get("AMENT_PREFIX_PATH"))
    foreign = [prefix for prefix in prefixes if prefix not in ours and holds_rclpy(prefix)]
    wanted = dict(values)
    for name, needed in paths.items():
        present = _entries(environ.get(name))
        if name in _IN_FRONT:
            entries = [entry for entry in needed if entry not in present] + present
        else:
            present = [entry for entry in present if entry in needed or not _lies_in(entry, foreign)]
            entries = present + [entry for entry in needed if entry not in present]
        if entries or name in environ:
            wanted[name] = os.pathsep.join(entries)
    return {name: value for name, value in wanted.items() if environ.get(name) != value}


def _start_again(environ: MutableMapping[str, str]) -> None:
    """Replace this process by a new start of the same program, with the current environment."""
    environ[_SECOND_START] = "1"
    python = sys.executable  # noqa: TID251  (this file stands alone in site-packages, and starts nothing new)
    os.execve(python, [python, *sys.orig_argv[1:]], dict(environ))


def begin() -> None:
    """Set the variables of this process. If it is too late for that, start the process again, once."""
    from course_paths import PATHS, VALUES

    environ = os.environ
    # The .pth file imports the module by name, and so finds it already imported.
    sys.modules[_BOOTSTRAPPER] = type(sys)(_BOOTSTRAPPER)
    if any(os.path.basename(word).startswith(_SETUP_BASH_HELPER) for word in sys.orig_argv[1:2]):  # noqa: PTH119
        return
    changes = variables(PATHS, VALUES, environ)
    second_start = environ.pop(_SECOND_START, None)
    environ.update(changes)
    if not second_start and any(name in changes for name in READ_AT_START):
        _start_again(environ)


def join() -> None:
    """Set the variables of a running process that another Python started.

    The loader of the process does not use changed paths of libraries: see environment/plain_kernel.py.
    """
    from course_paths import PATHS, VALUES

    os.environ.update(variables(PATHS, VALUES, os.environ))


def export_lines() -> str:
    """Return shell commands that give a terminal the variables that this process started with."""
    import shlex

    from course_paths import PATHS, VALUES

    present = [(name, os.environ[name]) for name in (*PATHS, *VALUES) if name in os.environ]
    return "\n".join(f"export {name}={shlex.quote(value)}" for name, value in present)
