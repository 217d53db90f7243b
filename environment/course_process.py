"""The start of every Python of the course's environment: ROS is found, and nothing has to be sourced.

The set-up copies this file into the site-packages of ``.venv``, with a ``.pth`` file that calls `begin` and
with the paths of this machine in ``course_paths.py``. So ``.venv/bin/python talker.py`` works in any
terminal, and so does everything that Python starts. Every start pays for what is done here, so it imports
nothing but ``os`` and ``sys``.

The ROS wheels bring a ``.pth`` of their own (ros-wheels-bootstrapper) that starts Python a second time with
``LD_LIBRARY_PATH`` set. `begin` runs before it and takes over, because that one

* trusts its guard variable, which a process of another environment can have set for its own libraries;
* keeps a sourced ROS of another distribution in front, so that the wrong rclpy is found;
* takes the library folders in the order of a set, another one at each start;
* costs each start 10 ms for what it imports, also when it has nothing to do.
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
# Set for the length of one second start, so that it can not become a third.
_SECOND_START = "_COURSE_SECOND_START"
_BOOTSTRAPPER = "ros_wheels_bootstrapper"
# The program that a workspace's setup.bash asks what to export. It compares with its own environment, so that
# must be the terminal's, or half of the variables are taken for set.
_SETUP_BASH_HELPER = "_local_setup_util"


def holds_rclpy(prefix: str) -> bool:
    """Tell whether a folder is the prefix of an installed ROS 2 (a workspace on top of one is not)."""
    return os.path.exists(f"{prefix}/share/rclpy/package.xml")  # noqa: PTH110 (pathlib costs 10 ms)


def _entries(value: str | None) -> list[str]:
    return [entry for entry in (value or "").split(os.pathsep) if entry]


def _lies_in(path: str, folders: Sequence[str]) -> bool:
    return any(path == folder or path.startswith(f"{folder}/") for folder in folders)


def variables(
    paths: Mapping[str, Sequence[str]], values: Mapping[str, str], environ: Mapping[str, str]
) -> dict[str, str]:
    """Return the variables that have to change for a process of the course, with their new values.

    An existing folder keeps its place, so that a student's sourced workspace stays in front of
    ROS. The folders of another ROS than the one this environment was set up with are dropped: two in one
    process never work. ``PATH`` keeps them, for a folder of programs is only looked at when nothing before it
    fits.

    Args:
        paths: for each search path variable, the folders that must be in it.
        values: the variables with one value.
        environ: the variables of the process as they are.
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
    """Replace this process by the same one, so that it starts with the environment it has now."""
    environ[_SECOND_START] = "1"
    python = sys.executable  # noqa: TID251  (this file stands alone in site-packages, and starts nothing new)
    os.execve(python, [python, *sys.orig_argv[1:]], dict(environ))


def begin() -> None:
    """Set the variables of this process; if it is too late for that, start the process again once."""
    from course_paths import PATHS, VALUES

    environ = os.environ
    # The .pth file imports the module by name and then finds it imported.
    sys.modules[_BOOTSTRAPPER] = type(sys)(_BOOTSTRAPPER)
    if any(os.path.basename(word).startswith(_SETUP_BASH_HELPER) for word in sys.orig_argv[1:2]):  # noqa: PTH119
        return
    changes = variables(PATHS, VALUES, environ)
    second_start = environ.pop(_SECOND_START, None)
    environ.update(changes)
    if not second_start and any(name in changes for name in READ_AT_START):
        _start_again(environ)


def join() -> None:
    """Set the variables of a process that runs already and was started by another Python.

    The paths of libraries come too late for its loader: see environment/plain_kernel.py.
    """
    from course_paths import PATHS, VALUES

    os.environ.update(variables(PATHS, VALUES, os.environ))


def export_lines() -> str:
    """Return shell commands that give a terminal the variables that this process started with."""
    import shlex

    from course_paths import PATHS, VALUES

    present = [(name, os.environ[name]) for name in (*PATHS, *VALUES) if name in os.environ]
    return "\n".join(f"export {name}={shlex.quote(value)}" for name, value in present)
