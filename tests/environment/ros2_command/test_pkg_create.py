"""`ros2 pkg create`: the files of a new package."""

from __future__ import annotations

import ast
import configparser
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_runtime.ros2_command.pkg_create import _write_cmake
from course_runtime.ros2_command.pkg_templates import Package
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

    Ros2 = Callable[..., subprocess.CompletedProcess[str]]

PYTHON_FILES = """\
my_pkg/LICENSE
my_pkg/my_pkg/__init__.py
my_pkg/my_pkg/simple_node.py
my_pkg/package.xml
my_pkg/resource/my_pkg
my_pkg/setup.cfg
my_pkg/setup.py
my_pkg/test/test_copyright.py
my_pkg/test/test_flake8.py
my_pkg/test/test_pep257.py
""".splitlines()


def create(ros2: Ros2, *words: str) -> str:
    done = ros2("pkg", "create", *words, "--maintainer-name", "Ada", "--maintainer-email", "ada@example.org")
    assert done.returncode == 0, done.stderr
    return done.stdout


def files(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_a_python_package(ros2: Ros2, tmp_path: Path) -> None:
    words = ("--build-type", "ament_python", "--node-name", "simple_node", "--license", "Apache-2.0")
    shown = create(ros2, *words, "my_pkg", "--dependencies", "rclpy", "std_msgs")
    assert (
        shown
        == f"""\
going to create a new package
package name: my_pkg
destination directory: {tmp_path}
package format: 3
version: 0.0.0
description: TODO: Package description
maintainer: ['Ada <ada@example.org>']
licenses: ['Apache-2.0']
build type: ament_python
dependencies: ['rclpy', 'std_msgs']
node_name: simple_node
creating folder ./my_pkg
creating ./my_pkg/package.xml
creating source folder
creating folder ./my_pkg/my_pkg
creating ./my_pkg/setup.py
creating ./my_pkg/setup.cfg
creating folder ./my_pkg/resource
creating ./my_pkg/resource/my_pkg
creating ./my_pkg/my_pkg/__init__.py
creating folder ./my_pkg/test
creating ./my_pkg/test/test_copyright.py
creating ./my_pkg/test/test_flake8.py
creating ./my_pkg/test/test_pep257.py
creating ./my_pkg/my_pkg/simple_node.py
"""
    )
    assert files(tmp_path) == PYTHON_FILES
    assert "'simple_node = my_pkg.simple_node:main'" in (tmp_path / "my_pkg/setup.py").read_text()
    for path in (tmp_path / "my_pkg").rglob("*.py"):
        ast.parse(path.read_text())
    config = configparser.ConfigParser()
    config.read(tmp_path / "my_pkg/setup.cfg")
    assert config["install"]["install_scripts"] == "$base/lib/my_pkg"
    assert "Apache License" in (tmp_path / "my_pkg/LICENSE").read_text()


def test_its_package_xml(ros2: Ros2, tmp_path: Path) -> None:
    create(
        ros2,
        "--build-type",
        "ament_python",
        "my_pkg",
        "--description",
        "a <b> & c",
        "--dependencies",
        "rclpy",
    )
    root = ElementTree.parse(tmp_path / "my_pkg/package.xml").getroot()
    assert root.attrib["format"] == "3"
    assert root.findtext("description") == "a <b> & c"
    assert [e.text for e in root.findall("depend")] == ["rclpy"]
    assert root.findtext("export/build_type") == "ament_python"
    maintainer = root.find("maintainer")
    assert maintainer is not None
    assert (maintainer.text, maintainer.attrib["email"]) == ("Ada", "ada@example.org")


def test_a_cmake_package_is_the_default(ros2: Ros2, tmp_path: Path) -> None:
    shown = create(ros2, "my_interfaces", "--dependencies", "std_msgs")
    assert "creating source and include folder\n" in shown
    assert files(tmp_path) == ["my_interfaces/CMakeLists.txt", "my_interfaces/package.xml"]
    assert (tmp_path / "my_interfaces/src").is_dir()
    lists = (tmp_path / "my_interfaces/CMakeLists.txt").read_text()
    assert "find_package(ament_cmake REQUIRED)\nfind_package(std_msgs REQUIRED)\n" in lists
    assert lists.endswith("\nament_package()\n")


def test_a_program_in_cpp_is_installed_where_ros2_run_finds_it(tmp_path: Path) -> None:
    package = Package("my_pkg", "ament_cmake", 3, "", "", "Ada", "ada@example.org", ("rclcpp",), "talker")
    _write_cmake(package, str(tmp_path))
    lists = (tmp_path / "CMakeLists.txt").read_text()
    assert "add_executable(talker src/talker.cpp)\n" in lists
    assert 'ament_target_dependencies(\n  talker\n  "rclcpp"\n)\n' in lists
    assert "install(TARGETS talker\n  DESTINATION lib/${PROJECT_NAME})\n" in lists
    assert "int main(" in (tmp_path / "src" / "talker.cpp").read_text()
    assert (tmp_path / "include" / "my_pkg").is_dir()


def test_an_unknown_license_is_a_warning(ros2: Ros2) -> None:
    assert "[WARNING]: Unknown license 'mine'." in create(ros2, "a_pkg", "--license", "mine")
    assert ros2("pkg", "create", "x", "--license", "?").stdout.startswith("Supported licenses:\nApache-2.0\n")


def test_nothing_is_left_of_a_package_that_cannot_be_written(ros2: Ros2, tmp_path: Path) -> None:
    # A file longer than this cannot be written, as on a full disk.
    limited = "ulimit -f 1; trap '' XFSZ; exec"
    words = ("my_pkg", "--build-type", "ament_python", "--license", "Apache-2.0")
    done = subprocess.run(
        ["bash", "-c", f'{limited} "$@"', "bash", *ros2("pkg", "create", "--help").args[:-3], "pkg", "create", *words],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert "./my_pkg cannot be written, and nothing of it is left: File too large" in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("words", "error"), cases(__file__, "what_can_not_be_created"))
def test_what_can_not_be_created(words: tuple[str, ...], error: str, ros2: Ros2, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    done = ros2("pkg", "create", *words)
    assert error in done.stderr
    assert done.returncode == 1
    assert files(tmp_path) == []


@pytest.mark.slow
def test_colcon_builds_what_was_created(ros2: Ros2, env: dict[str, str], tmp_path: Path) -> None:
    create(
        ros2,
        "--build-type",
        "ament_python",
        "--node-name",
        "simple_node",
        "py_pkg",
        "--dependencies",
        "rclpy",
    )
    create(ros2, "--build-type", "ament_cmake", "cmake_pkg")
    programs = Path(sys.executable).parent
    path = f"{programs}{os.pathsep}{env['PATH']}"
    built = subprocess.run(
        [str(programs / "colcon"), "build"],
        cwd=tmp_path,
        env=env | {"PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    script = ". install/setup.sh && exec python -m course_runtime.ros2_command run py_pkg simple_node"
    hello = subprocess.run(
        ["/bin/sh", "-c", script],
        cwd=tmp_path,
        env=env | {"PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert hello.stdout == "Hi from py_pkg.\n", hello.stderr
