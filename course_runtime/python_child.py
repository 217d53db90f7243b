"""The only way to start a Python process of this project: its command line, environment and folder.

A command of the course may be typed in any folder, even in one that a student has filled. Python imports from the
current folder, from relative folders of ``PYTHONPATH``, and from places that other variables name. A process of this
project must not do that: a ``json.py`` there would run with the rights of the instructor. The linter forbids
``sys.executable`` everywhere else.

A student's own program is not started in this way. It finds the modules next to it, as Python always does.
"""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

INTERPRETER = sys.executable  # noqa: TID251  (here it is made into a command line)
"""The path of this Python. To start it, use :func:`python_child`."""
SAFE_PATH = "PYTHONSAFEPATH"
"""The variable with the effect of ``-P``. All child processes inherit it, so it must be removed for a student's
program.
"""
TYPED_PYTHONPATH = "COURSE_PYTHONPATH"
"""The variable with the terminal's ``PYTHONPATH``, for a student's program: ``./course`` drops relative folders."""
SEARCH_PATHS = {
    *("PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "COLCON_PREFIX_PATH")
}
"""The variables that contain a list of folders."""
_OF_PYTHON = "PYTHON"
_KEPT_OF_PYTHON = {
    "PYTHONPATH",
    "PYTHONCOERCECLOCALE",
    "PYTHONDONTWRITEBYTECODE",
    "PYTHONFAULTHANDLER",
    "PYTHONHASHSEED",
    "PYTHONIOENCODING",
    "PYTHONNOUSERSITE",
    "PYTHONUNBUFFERED",
    "PYTHONUTF8",
}
"""Variables that affect how a process reads, writes and prints. Python's other variables name code or files."""
_LISTED = {
    *SEARCH_PATHS,
    *("CONDA_PREFIX", "PYTHONUTF8", "TZ", "VIRTUAL_ENV"),
    *(
        "LANG",
        "LANGUAGE",
        "LC_ALL",
        "LC_COLLATE",
        "LC_CTYPE",
        "LC_MESSAGES",
        "LC_MONETARY",
        "LC_NUMERIC",
        "LC_TIME",
    ),
    *("ROS_DISTRO", "ROS_PYTHON_VERSION", "ROS_VERSION", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_DOMAIN_ID"),
    *("ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_PYTHON_CHECK_FIELDS", "RMW_IMPLEMENTATION"),
    *("FASTDDS_BUILTIN_TRANSPORTS", "RCUTILS_COLORIZED_OUTPUT", "RCUTILS_CONSOLE_OUTPUT_FORMAT"),
    *("RCUTILS_LOGGING_BUFFERED_STREAM", "RCUTILS_LOGGING_USE_STDOUT"),
    *("_ROS_WHEELS_BOOTSTRAP_COMPLETE",),
}
"""The variables that Python and ROS need. Any other variable may contain a secret, such as a token of the user."""


@dataclass(frozen=True)
class PythonChild:
    """A Python process that can be started.

    Attributes:
        command: The command line.
        environment: The whole environment.
        folder: The current folder.
    """

    command: list[str]
    environment: dict[str, str]
    folder: str | None

    def start(self, **options: Any) -> subprocess.Popen[bytes]:
        """Start the process.

        Args:
            options: Further arguments of :class:`subprocess.Popen`.
        """
        return subprocess.Popen(self.command, env=self.environment, cwd=self.folder, **options)


def python_child(
    *words: str, environment: Mapping[str, str] | None = None, folder: str | None = "/"
) -> PythonChild:
    """Return a Python process, not yet started, that imports nothing from the current folder.

    Args:
        words: The arguments of Python, such as ``"-m"``, the name of a module and the arguments of the module.
        environment: The environment to clean; None for the environment of this process.
        folder: The current folder of the process. The default is the root of the file system, to which no student can
            write. None means the folder of this process, for a process that gets relative paths.
    """
    cleaned = clean_environment(os.environ if environment is None else environment)
    return PythonChild([INTERPRETER, "-P", *words], cleaned, folder)


def clean_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment without relative folders in search paths and without what makes Python run other code.

    The folders of a sourced ROS are absolute, so they stay. An empty entry of a search path means the current folder.
    """
    kept = {
        name: value
        for name, value in environment.items()
        if not name.startswith(_OF_PYTHON) or name in _KEPT_OF_PYTHON
    }
    for name in SEARCH_PATHS:
        if name in kept:
            absolute = [entry for entry in kept[name].split(os.pathsep) if entry.startswith("/")]
            kept[name] = os.pathsep.join(absolute)
            if not absolute:
                del kept[name]
    return kept


def listed_environment(environment: Mapping[str, str], *more: str) -> dict[str, str]:
    """Return the variables of an environment that Python and ROS need, and nothing else of the user's.

    Args:
        more: The names of further variables to keep.
    """
    return {name: value for name, value in environment.items() if name in _LISTED or name in more}


def installed_program(name: str) -> Path:
    """Return the path at which the set-up installs a program next to this Python. The program may not exist."""
    return Path(INTERPRETER).with_name(name)
