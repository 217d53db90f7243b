"""Where `ros2` and `launch` land, and that they never hide real ones."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
from typing import TYPE_CHECKING

import pytest

from course_runtime.ros2_command.install import LAUNCH_FRONT, install
from course_runtime.ros2_command.real_installation import find_real_command

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def fresh(tmp_path: Path) -> Path:
    """A virtual environment without anything, in a folder with a space in its name."""
    folder = tmp_path / "my env"
    venv.create(folder, with_pip=False, symlinks=True)
    install(folder)
    return folder


def python(folder: Path, code: str, **variables: str) -> str:
    env = {"PATH": os.environ["PATH"], "HOME": str(folder), **variables}
    done = subprocess.run(
        [folder / "bin/python", "-c", code], env=env, capture_output=True, text=True, check=False, cwd=folder
    )
    return (done.stdout or done.stderr).strip()


def package(folder: Path, name: str, text: str = "real = True\n") -> None:
    (folder / name).mkdir(parents=True)
    (folder / name / "__init__.py").write_text(text)


def site_packages(folder: Path) -> Path:
    return next(folder.glob("lib/python3*/site-packages"))


def test_launch_can_be_imported(fresh: Path) -> None:
    code = "from launch import LaunchDescription; import launch; print(launch.__file__)"
    assert python(fresh, code).endswith("course_runtime/launch_front/launch/__init__.py")
    assert python(fresh, "from launch_ros.actions import Node; print(Node.__name__)") == "Node"


def test_ctrl_c_while_the_command_is_loaded_ends_it_without_a_word(fresh: Path, tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text(
        "import os, signal, sys\n"
        "class Interrupting:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'course_runtime.ros2_command.main':\n"
        "            os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Interrupting())\n"
    )
    env = {"PATH": os.environ["PATH"], "HOME": str(fresh), "PYTHONPATH": str(tmp_path)}
    done = subprocess.run(
        [fresh / "bin/ros2", "topic", "list"], env=env, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (2, "")


@pytest.mark.parametrize("place", ["PYTHONPATH", "site-packages", "a .pth file that comes later"])
def test_a_real_launch_comes_first_wherever_it_is(place: str, fresh: Path, tmp_path: Path) -> None:
    real = tmp_path / "real"
    variables = {}
    if place == "site-packages":
        real = site_packages(fresh)
    elif place == "PYTHONPATH":
        variables["PYTHONPATH"] = str(real)
    else:
        (site_packages(fresh) / "zzzz.pth").write_text(f"{real}\n")
    package(real, "launch")
    assert python(fresh, "import launch; print(launch.real)", **variables) == "True"


@pytest.mark.parametrize("real", ["nowhere", "PYTHONPATH", "a .pth file that comes later"])
def test_a_folder_of_launch_files_is_no_launch(real: str, fresh: Path, tmp_path: Path) -> None:
    # `colcon build --symlink-install` puts the folder of a package into the search path.
    files, other = tmp_path / "my_robot_pkg", tmp_path / "real"
    (files / "launch").mkdir(parents=True)
    (files / "launch" / "remap.launch.yaml").touch()
    package(other, "launch")
    if real.startswith("a .pth"):
        (site_packages(fresh) / "zzzz.pth").write_text(f"{other}\n")
    path = f"{files}:{other}" if real == "PYTHONPATH" else str(files)
    shown = python(fresh, "import launch; print(launch.__file__)", PYTHONPATH=path)
    folder = LAUNCH_FRONT if real == "nowhere" else other
    assert shown == str(folder / "launch" / "__init__.py")
    if real == "nowhere":
        code = "from launch_ros.actions import Node; import launch_xml; print(Node.__name__)"
        assert python(fresh, code, PYTHONPATH=path) == "Node"


def test_parts_of_two_launches_are_never_mixed(fresh: Path) -> None:
    package(site_packages(fresh), "launch")
    assert "No module named 'launch_ros'" in python(fresh, "import launch_ros")


def test_other_modules_are_left_alone(fresh: Path) -> None:
    assert "No module named 'launch_something'" in python(fresh, "import launch_something")
    assert "'launch' in" not in python(fresh, "import sys; assert 'launch' not in sys.modules")


def test_the_command_starts(fresh: Path) -> None:
    # The environment is empty, but `-h` needs nothing of it.
    done = subprocess.run(
        [fresh / "bin/ros2", "-h"], capture_output=True, text=True, check=False, env={"PATH": "/usr/bin:/bin"}
    )
    assert "Various topic related sub-commands" in done.stdout, done.stderr


def test_without_ros_it_says_what_to_do(fresh: Path) -> None:
    done = subprocess.run(
        [fresh / "bin/ros2", "topic", "list"],
        capture_output=True,
        text=True,
        check=False,
        env={"PATH": "/bin"},
    )
    assert done.stderr.startswith("ros2: rclpy is not installed in this environment (")
    assert done.returncode == 1


def test_installing_again_changes_nothing(fresh: Path) -> None:
    def state() -> dict[str, tuple[int, bytes]]:
        written = [fresh / "bin/ros2", *site_packages(fresh).glob("course_launch_front.*")]
        return {str(path): (path.stat().st_mtime_ns, path.read_bytes()) for path in written}

    before = state()
    assert len(before) == 3
    install(fresh)
    assert state() == before


def test_what_is_no_environment_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="is not a virtual environment"):
        install(tmp_path)


def fake_installation(folder: Path) -> Path:
    (folder / "bin").mkdir(parents=True)
    program = folder / "bin/ros2"
    program.write_text('#!/bin/sh\necho "the real one: $*"\nexit 7\n')
    program.chmod(0o755)
    return program


def test_a_real_ros2_runs_instead(fresh: Path, tmp_path: Path) -> None:
    program = fake_installation(tmp_path / "opt")
    path = f"{fresh / 'bin'}:{program.parent}:/usr/bin:/bin"
    done = subprocess.run(
        [fresh / "bin/ros2", "topic", "bw"],
        env={"PATH": path, "AMENT_PREFIX_PATH": str(tmp_path / "opt")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.stdout, done.returncode) == ("the real one: topic bw\n", 7)


def test_a_ros2_of_an_installation_that_is_not_in_use_does_not_run(tmp_path: Path) -> None:
    program = fake_installation(tmp_path / "opt")
    environ = {"PATH": str(program.parent), "AMENT_PREFIX_PATH": sys.prefix}
    assert find_real_command(environ) is None
    assert find_real_command(environ | {"AMENT_PREFIX_PATH": str(tmp_path / "opt")}) == program


def test_two_of_our_own_do_not_call_each_other(fresh: Path) -> None:
    environ = {"PATH": str(fresh / "bin"), "AMENT_PREFIX_PATH": str(fresh)}
    assert find_real_command(environ) is None
