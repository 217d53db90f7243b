"""The paths of the course's environment, and the variables with which processes find it."""

from __future__ import annotations

import os
import pwd
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_runtime.interface_packages import interface_packages
from course_runtime.ros_flavour import DISTRO

if TYPE_CHECKING:
    from pathlib import Path

    from course_runtime.ros_flavour import Ros

INTERFACES = "my_robot_interfaces"


@dataclass(frozen=True)
class Place:
    """The paths of the environment.

    Attributes:
        root: The folder of the course.
        base_python: The interpreter from which the environment is made.
    """

    root: Path
    base_python: Path

    @property
    def prefix(self) -> Path:
        """The environment."""
        return self.root / ".venv"

    @property
    def python(self) -> Path:
        """The interpreter of the environment."""
        return self.prefix / "bin" / "python"

    @property
    def site_packages(self) -> Path:
        """The folder of the installed Python packages."""
        major, minor = sys.version_info[:2]
        return self.prefix / "lib" / f"python{major}.{minor}" / "site-packages"

    @property
    def notes(self) -> Path:
        """The folder of the set-up's own files inside the environment."""
        return self.prefix / "course"

    @property
    def locked(self) -> Path:
        """The folder that a set-up locks. No box sees it, because any process that can read a folder can lock it."""
        return self.root

    @property
    def runtime(self) -> Path:
        """The folder of this package."""
        return self.root / "course_runtime"

    @property
    def interfaces(self) -> tuple[Path, ...]:
        """The sources of the packages with interfaces: the course's own, and those of its chapters."""
        return interface_packages(self.root)

    @property
    def warning(self) -> str:
        """A warning about a folder that is unsuitable for the course, or an empty text."""
        if not any(character.isspace() for character in str(self.root)):
            return ""
        return (
            f"there is a space in {self.root}. The notebooks and the grader do not mind, but colcon's setup "
            "files and the first line of a script do: packages of your own will not start. "
            "Better move the folder."
        )

    def lock(self, name: str) -> Path:
        """Return the path of a lock file."""
        return self.root / "environment" / "requirements" / f"{name}.lock"


def environment_paths(place: Place, ros: Ros) -> dict[str, list[str]]:
    """Return the folders that each search path variable of a process of the course must have, in order."""
    prefix = str(place.prefix)
    libraries = [f"{prefix}/lib", *sorted(str(path) for path in place.site_packages.glob("ros_*.libs"))]
    own: dict[str, list[str]] = {
        "PATH": [f"{prefix}/bin"],
        "AMENT_PREFIX_PATH": [prefix],
        "CMAKE_PREFIX_PATH": [prefix],
        "LD_LIBRARY_PATH": libraries,
        "PYTHONPATH": [],
    }
    return {name: [*entries, *ros.paths.get(name, ())] for name, entries in own.items()}


def environment_values(place: Place) -> dict[str, str]:
    """Return the variables with one value that a process of the course has."""
    return {
        # CMake looks for Python there first; without it, it takes the newest one on the PATH.
        "VIRTUAL_ENV": str(place.prefix),
        "ROS_DISTRO": DISTRO,
        "ROS_VERSION": "2",
        "ROS_PYTHON_VERSION": "3",
        # Names of students and files are UTF-8, whatever the terminal's locale says.
        "PYTHONUTF8": "1",
        # rclpy imports numpy. Its library would start a thread for each core, and each thread begins with a busy loop:
        # a quarter of the CPU time of importing rclpy on two cores, and more on more cores.
        "OPENBLAS_NUM_THREADS": "1",
    }


def owner(folder: Path) -> str:
    """Return the name of a folder's owner; the owner's number if it has no name on this machine.

    If several people share a course, one of them has to set it up.
    """
    number = folder.stat().st_uid
    try:
        return pwd.getpwuid(number).pw_name
    except KeyError:
        return f"user {number}"


def may_write(folder: Path) -> bool:
    """True if this user may write to a folder."""
    return os.access(folder, os.W_OK)
