"""Finds and builds interface packages: the course's own, and those in the folders of its chapters.

A folder contains only definitions, and the set-up makes a package of them, because students write such a package in a
lab, and nothing that they receive may be the answer.
"""

from __future__ import annotations

import shutil
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

ONLY_PYTHON_FILE = Path(__file__).with_name("only_python.cmake")
ONLY_PYTHON = (
    "-G",
    "Ninja",
    f"-DCMAKE_PROJECT_INCLUDE={ONLY_PYTHON_FILE}",
    "-DCMAKE_C_FLAGS_RELEASE=-O0 -DNDEBUG",
    "-DCMAKE_CXX_FLAGS_RELEASE=-O0 -DNDEBUG",
)
"""Arguments for CMake that generate interfaces for Python nodes only."""

# The folders that may contain the chapters: in the course, and in a hand-out.
_CHAPTERS = ("solutions", "exercises")
_DEFINITIONS = (".action", ".msg", ".srv")
_PACKAGE_XML = """\
<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>Interfaces of the course.</description>
  <maintainer email="course@example.com">The course</maintainer>
  <license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
{dependencies}
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
_CMAKE_LISTS = """\
cmake_minimum_required(VERSION 3.8)
project({name})
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(${{PROJECT_NAME}} {definitions})
ament_package()
"""
_TAGS = {
    "rosidl_default_generators": "buildtool_depend",
    "action_msgs": "depend",
    "rosidl_default_runtime": "exec_depend",
}


def interface_packages(root: Path) -> tuple[Path, ...]:
    """Return the folders of all packages, in a fixed order. Each folder has the name of its package.

    Args:
        root: The folder of the course.
    """
    patterns = ("environment/interfaces/*", *(f"{name}/*/interfaces/*" for name in _CHAPTERS))
    return tuple(
        folder for pattern in patterns for folder in sorted(root.glob(pattern)) if _definitions(folder)
    )


def missing_packages(root: Path) -> list[Path]:
    """Return the folders of the packages that this Python cannot import, since they are neither built nor sourced."""
    return [package for package in interface_packages(root) if find_spec(package.name) is None]


def only_python_needs(package: Path) -> bool:
    """Return True if interfaces for Python are enough, because a package has no message that others use in C++."""
    return not any(package.glob("msg/*.msg"))


def build_command(
    colcon: Path, python: Path, packages: Sequence[Path], prefix: Path, scratch: Path, *, light: bool = False
) -> list[str | Path]:
    """Write the packages, and return the command that builds them into a prefix.

    Args:
        colcon: The path of colcon.
        python: The interpreter for which interfaces are generated.
        packages: The folders with the definitions.
        prefix: The common install folder of all packages.
        scratch: An empty folder for intermediate files.
        light: True to generate interfaces for Python only.

    Raises:
        OSError: The packages cannot be written.
    """
    sources = scratch / "interfaces"
    for package in packages:
        write_package(package, sources / package.name)
    # Release defines NDEBUG. With asserts, a field of a wrong type would end a student's process.
    generated = ONLY_PYTHON if light else ("-G", "Ninja")
    cmake = [*generated, f"-DPython3_EXECUTABLE={python}", "-DCMAKE_BUILD_TYPE=Release"]
    command: list[str | Path] = [colcon, "--log-base", scratch / "colcon-log", "build"]
    command += ["--base-paths", sources, "--build-base", scratch / "build"]
    command += ["--merge-install", "--install-base", prefix, "--event-handlers", "console_direct+"]
    command += ["--cmake-args", *cmake, "-DBUILD_TESTING=OFF", "--no-warn-unused-cli"]
    return command


def write_package(folder: Path, place: Path) -> None:
    """Write a package: a copy of the folder's definitions, and the files that colcon and CMake need."""
    shutil.copytree(folder, place)
    names = [file.relative_to(folder).as_posix() for file in _definitions(folder)]
    needless = {"action_msgs"} if not any(name.endswith(".action") for name in names) else set()
    lines = [f"  <{tag}>{name}</{tag}>" for name, tag in _TAGS.items() if name not in needless]
    package_xml = _PACKAGE_XML.format(name=folder.name, dependencies="\n".join(lines))
    (place / "package.xml").write_text(package_xml, encoding="utf-8")
    definitions = " ".join(f'"{name}"' for name in names)
    cmake_lists = _CMAKE_LISTS.format(name=folder.name, definitions=definitions)
    (place / "CMakeLists.txt").write_text(cmake_lists, encoding="utf-8")


def _definitions(folder: Path) -> list[Path]:
    return sorted(file for file in folder.glob("*/*") if file.suffix in _DEFINITIONS)
