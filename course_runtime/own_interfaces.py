"""Finds the interface packages of a course in a repository of its own, built before a command that needs them.

The set-up of a clone has built those of its course already.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

from course_runtime.installation import installing
from course_runtime.interface_packages import missing_packages
from course_runtime.python_child import python_child


class CannotBuildInterfaces(RuntimeError):
    """An interface package of the course was not built. The message says why, and what brings the build tools."""


def built_interfaces(course: Path) -> list[Path]:
    """Return the prefixes of the course's interface packages that this Python cannot import, built if needed.

    Another process builds: the one with a class's gradebook imports nothing that executes a program.

    Args:
        course: The top folder of the course.

    Raises:
        CannotBuildInterfaces: A package cannot be built.
    """
    missing = missing_packages(course)
    if not missing:
        return []
    builder = python_child("-m", "autograder.interface_builder", *map(str, missing)).start(
        stdout=subprocess.PIPE
    )
    said = builder.communicate()[0].decode()
    if builder.returncode:
        raise CannotBuildInterfaces(
            f"{said.strip()}. If a tool is missing, source the setup script of ROS 2 Jazzy, or type: "
            f"{installing('interfaces')}"
        )
    return [Path(line) for line in said.splitlines()]
