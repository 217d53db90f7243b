"""Decides which ROS 2 the course uses: one that is sourced, or the pinned wheels.

A sourced Jazzy (a system's ``/opt/ros/jazzy`` or a RoboStack environment) is used when this Python can import
its rclpy. In every other case the wheels of ``requirements/ros.lock`` are installed. The set-up decides once
and records what it found, so that nothing has to be sourced afterwards.
"""

from __future__ import annotations

import json
import platform
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from course_runtime.course_process import holds_rclpy

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

Flavour = Literal["wheels", "system", "robostack"]

DISTRO = "jazzy"
# The file with the set-up's decision, below the prefix of the environment.
RECORD = Path("course") / "ros.json"

# The search paths that sourcing a ROS 2 sets. PATH is not among them, because it has the programs of the whole
# session.
SOURCED_PATHS = ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH")

# The wheels support manylinux_2_28, x86_64, CPython 3.11 (the project's oldest) to 3.14.
_OLDEST_GLIBC = (2, 28)
_PYTHONS = ((3, 11), (3, 14))


class NoRosError(Exception):
    """No ROS 2 Jazzy is sourced and the wheels do not run here. The text says what to do."""


@dataclass(frozen=True)
class Ros:
    """The ROS 2 that an environment is set up with.

    Attributes:
        flavour: The kind of installation.
        paths: What sourcing ROS adds to the search path variables; empty for the wheels.
        notice: A line for the user about a sourced ROS that is not used; empty if there is none.
    """

    flavour: Flavour
    paths: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    notice: str = ""

    @property
    def is_sourced(self) -> bool:
        """True if ROS comes from outside the environment."""
        return self.flavour != "wheels"


@dataclass(frozen=True)
class Machine:
    """The facts that decide whether the wheels run on this machine."""

    system: str
    processor: str
    glibc: tuple[int, int] | None
    python: tuple[int, int]

    @classmethod
    def here(cls) -> Machine:
        """Return the machine on which this process runs. `glibc` is None if it has another C library."""
        name, version = platform.libc_ver()
        numbers = [int(part) for part in version.split(".")[:2]] if name == "glibc" else []
        glibc = (numbers[0], numbers[1]) if len(numbers) == 2 else None
        return cls(platform.system(), platform.machine(), glibc, sys.version_info[:2])

    def why_no_wheels(self) -> str:
        """Return why the wheels do not run here; empty if they do."""
        if self.system != "Linux" or self.processor != "x86_64":
            return f"they exist for Linux on x86_64 only, this is {self.system} on {self.processor}"
        if self.glibc is None or self.glibc < _OLDEST_GLIBC:
            return "they need the GNU C library 2.28 or newer"
        if not _PYTHONS[0] <= self.python <= _PYTHONS[1]:
            version = ".".join(str(number) for number in self.python)
            return f"they exist for CPython 3.11 to 3.14, this is {version}"
        return ""


def _is_course_environment(prefix: str) -> bool:
    """Return True if a prefix is a course's own environment, whose variables its processes inherit."""
    return (Path(prefix) / RECORD).exists()


def sourced_prefixes(environ: Mapping[str, str]) -> list[str]:
    """Return the prefixes of the sourced ROS 2 installations, without environments of the course."""
    prefixes = [prefix for prefix in environ.get("AMENT_PREFIX_PATH", "").split(":") if prefix]
    return [prefix for prefix in prefixes if holds_rclpy(prefix) and not _is_course_environment(prefix)]


def _sourced_paths(environ: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    """Return the folders of the sourced ROS in its search paths, without workspaces and course environments."""
    prefixes = sourced_prefixes(environ)
    found = {}
    for name in SOURCED_PATHS:
        entries = environ.get(name, "").split(":")
        inside = [e for e in entries if any(e == p or e.startswith(f"{p}/") for p in prefixes)]
        if inside:
            found[name] = tuple(inside)
    return found


def decide(environ: Mapping[str, str], machine: Machine, imports_rclpy: Callable[[], bool]) -> Ros:
    """Decide which ROS 2 to use.

    Args:
        environ: The variables of the process.
        machine: The machine.
        imports_rclpy: Tries whether this Python can import rclpy with these variables. Called for a Jazzy
        only.

    Raises:
        NoRosError: No Jazzy can be used, and the wheels do not run here.
    """
    prefixes = sourced_prefixes(environ)
    # An environment of the course says "jazzy", too, and sourcing a second ROS does not always change this variable.
    distro = environ.get("ROS_DISTRO", "") if prefixes else ""
    if distro == DISTRO and imports_rclpy():
        conda = environ.get("CONDA_PREFIX")
        return Ros("robostack" if conda in prefixes else "system", _sourced_paths(environ))
    notice = ""
    if distro == DISTRO:
        python = ".".join(str(number) for number in machine.python)
        notice = (
            f"A ROS 2 Jazzy is sourced ({prefixes[0]}), but this Python {python} cannot import its rclpy: "
            "the course uses its own wheels. To use the sourced one: PYTHON=/usr/bin/python3 ./course setup"
        )
    elif prefixes:
        notice = (
            f"ROS 2 {distro or '(which one is not said)'} is sourced ({prefixes[0]}). The course is about "
            "Jazzy: it uses its own wheels and leaves the sourced one out of its processes."
        )
    reason = machine.why_no_wheels()
    if reason:
        raise NoRosError(
            f"{notice}\n" * bool(notice) + f"The ROS 2 Jazzy wheels do not run here: {reason}. "
            "Source a ROS 2 Jazzy first, or get one with environment/jazzy.Dockerfile or environment/robostack.yml."
        )
    return Ros("wheels", notice=notice)


def save(ros: Ros, prefix: Path) -> None:
    """Record the decision in the environment at `prefix`."""
    record = prefix / RECORD
    record.parent.mkdir(parents=True, exist_ok=True)
    content = json.dumps({"flavour": ros.flavour, "paths": dict(ros.paths)}, indent=1)
    record.write_text(f"{content}\n", encoding="utf-8")


def load(prefix: Path) -> Ros | None:
    """Return the recorded decision of the environment at `prefix`; None if none can be read."""
    try:
        record = json.loads((prefix / RECORD).read_text(encoding="utf-8"))
        paths = {name: tuple(entries) for name, entries in record["paths"].items()}
        return Ros(record["flavour"], paths)
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return None


def with_recorded(environ: Mapping[str, str], recorded: Ros | None) -> dict[str, str]:
    """Return the variables from the time when the recorded ROS was sourced, if no ROS is sourced now.

    So an environment that was set up with a sourced ROS keeps it in a terminal in which no ROS is sourced.
    """
    result = dict(environ)
    if recorded is None or not recorded.is_sourced or sourced_prefixes(environ):
        return result
    for name, entries in recorded.paths.items():
        result[name] = ":".join([*entries, *(e for e in environ.get(name, "").split(":") if e)])
    result["ROS_DISTRO"] = DISTRO
    return result
