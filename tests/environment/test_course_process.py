"""The start of a Python of the environment: its variables, and real starts in hostile surroundings."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from course_runtime.course_process import variables

OURS = {
    "PATH": ["/course/.venv/bin"],
    "AMENT_PREFIX_PATH": ["/course/.venv"],
    "LD_LIBRARY_PATH": ["/course/.venv/lib", "/course/.venv/ros_rcl.libs"],
    "PYTHONPATH": [],
}
VALUES = {"ROS_DISTRO": "jazzy"}


@pytest.fixture
def foreign(tmp_path: Path) -> Path:
    """Return the prefix of another ROS 2 than the course's."""
    package = tmp_path / "opt/ros/humble/share/rclpy/package.xml"
    package.parent.mkdir(parents=True)
    package.write_text("<package/>")
    return tmp_path / "opt/ros/humble"


def test_a_bare_terminal_gets_everything() -> None:
    assert variables(OURS, VALUES, {"PATH": "/usr/bin"}) == {
        "PATH": "/course/.venv/bin:/usr/bin",
        "AMENT_PREFIX_PATH": "/course/.venv",
        "LD_LIBRARY_PATH": "/course/.venv/lib:/course/.venv/ros_rcl.libs",
        "ROS_DISTRO": "jazzy",
    }


def test_a_process_that_has_everything_changes_nothing() -> None:
    environ = {"PATH": "/usr/bin", "HOME": "/home/me"}
    environ.update(variables(OURS, VALUES, environ))
    assert variables(OURS, VALUES, environ) == {}


def test_a_sourced_workspace_stays_in_front_of_ros() -> None:
    environ = {"AMENT_PREFIX_PATH": "/home/me/ros2_ws/install/my_pkg", "LD_LIBRARY_PATH": "/home/me/lib"}
    changes = variables(OURS, VALUES, environ)
    assert changes["AMENT_PREFIX_PATH"] == "/home/me/ros2_ws/install/my_pkg:/course/.venv"
    assert changes["LD_LIBRARY_PATH"].startswith("/home/me/lib:/course/.venv/lib")


def test_the_folders_of_another_ros_are_dropped_except_from_the_path(foreign: Path) -> None:
    environ = {
        "PATH": f"{foreign}/bin:/usr/bin",
        "AMENT_PREFIX_PATH": f"/home/me/install:{foreign}",
        "LD_LIBRARY_PATH": f"{foreign}/lib:{foreign}-other/lib",
        "PYTHONPATH": f"{foreign}/lib/python3.10/site-packages:/home/me/tools",
        "ROS_DISTRO": "humble",
    }
    changes = variables(OURS, VALUES, environ)
    assert changes["PATH"] == f"/course/.venv/bin:{foreign}/bin:/usr/bin"
    assert changes["AMENT_PREFIX_PATH"] == "/home/me/install:/course/.venv"
    assert changes["LD_LIBRARY_PATH"].split(":")[0] == f"{foreign}-other/lib"
    assert changes["PYTHONPATH"] == "/home/me/tools"
    assert changes["ROS_DISTRO"] == "jazzy"


def test_a_ros_that_was_sourced_at_set_up_is_not_foreign(foreign: Path) -> None:
    paths = {
        **OURS,
        "AMENT_PREFIX_PATH": ["/course/.venv", str(foreign)],
        "PYTHONPATH": [f"{foreign}/python"],
    }
    changes = variables(paths, VALUES, {"PYTHONPATH": f"{foreign}/python", "AMENT_PREFIX_PATH": str(foreign)})
    assert changes["AMENT_PREFIX_PATH"] == f"{foreign}:/course/.venv"
    assert "PYTHONPATH" not in changes


# The rest starts the real Python of this environment.

IMPORT_ROS = "import rclpy, my_robot_interfaces.srv; print('found', rclpy.__file__)"


def start(environ: dict[str, str], *arguments: str) -> str:
    """Start a Python of the environment and return what it printed."""
    command = [sys.executable, *arguments]
    return subprocess.run(command, env=environ, capture_output=True, text=True, check=True).stdout


@pytest.fixture
def bare() -> dict[str, str]:
    """Return the variables of a terminal that knows nothing of ROS."""
    return {"PATH": "/usr/bin:/bin", "HOME": os.environ.get("HOME", "/")}


@pytest.mark.ros
def test_ros_is_found_with_nothing_sourced(bare: dict[str, str]) -> None:
    assert sys.prefix in start(bare, "-c", IMPORT_ROS)


@pytest.mark.ros
def test_numpy_starts_no_thread_when_it_is_imported(bare: dict[str, str]) -> None:
    code = "import os, numpy; print(len(os.listdir('/proc/self/task')))"
    assert start(bare, "-c", code) == "1\n"


@pytest.mark.ros
def test_another_ros_in_front_does_not_get_in_the_way(bare: dict[str, str], foreign: Path) -> None:
    package = foreign / "lib/python3/site-packages/rclpy/__init__.py"
    package.parent.mkdir(parents=True)
    package.write_text("raise ImportError('the wrong rclpy')\n")
    environ = {**bare, "PYTHONPATH": str(package.parent.parent), "AMENT_PREFIX_PATH": str(foreign)}
    assert sys.prefix in start(environ, "-c", IMPORT_ROS)


@pytest.mark.ros
def test_libraries_of_another_environment_that_set_the_guard_are_not_trusted(bare: dict[str, str]) -> None:
    environ = {**bare, "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1", "LD_LIBRARY_PATH": "/another/.venv/lib"}
    assert sys.prefix in start(environ, "-c", IMPORT_ROS)


@pytest.mark.ros
def test_arguments_input_and_options_survive_the_second_start(bare: dict[str, str], tmp_path: Path) -> None:
    script = tmp_path / "a b.py"
    script.write_text("import sys; print(sys.argv[1:], sys.flags.optimize, sys.stdin.read())")
    command = [sys.executable, "-O", str(script), "--ros-args", "", "ü ß"]
    done = subprocess.run(command, env=bare, input="typed", capture_output=True, text=True, check=True)
    assert done.stdout == "['--ros-args', '', 'ü ß'] 1 typed\n"


@pytest.mark.parametrize("locale", [{"PYTHONUTF8": "0", "LC_ALL": "C"}, {"PYTHONUTF8": "0", "LANG": "POSIX"}])
def test_names_are_utf_8_whatever_the_locale_says(
    bare: dict[str, str], tmp_path: Path, locale: dict[str, str]
) -> None:
    code = "import pathlib, sys; path = pathlib.Path(sys.argv[1]); path.touch(); print(path.name)"
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "Müller_學生")],
        env={**bare, **locale},
        capture_output=True,
        check=True,
    )
    assert done.stdout == "Müller_學生\n".encode()
    assert (tmp_path / "Müller_學生").exists()


@pytest.mark.ros
def test_the_marker_of_the_second_start_does_not_reach_children(bare: dict[str, str]) -> None:
    assert start(bare, "-c", "import os; print('_COURSE_SECOND_START' in os.environ)") == "False\n"


@pytest.mark.ros
def test_what_setup_bash_asks_sees_the_terminal_as_it_is(bare: dict[str, str], tmp_path: Path) -> None:
    helper = tmp_path / "_local_setup_util_sh.py"
    helper.write_text("import os; print(os.environ.get('AMENT_PREFIX_PATH'), os.environ['PATH'])")
    assert start(bare, str(helper)) == "None /usr/bin:/bin\n"


@pytest.mark.ros
@pytest.mark.skipif(" " in sys.prefix, reason="colcon's own setup files cannot take a space in a path")
def test_setup_bash_of_the_environment_gives_a_bare_terminal_its_variables(bare: dict[str, str]) -> None:
    command = f'. "{sys.prefix}/local_setup.sh"; echo "$AMENT_PREFIX_PATH|$PATH"'
    done = subprocess.run(["sh", "-c", command], env=bare, capture_output=True, text=True, check=True)
    assert done.stdout.startswith(f"{sys.prefix}|{sys.prefix}/bin:/usr/bin:/bin")


@pytest.mark.ros
@pytest.mark.parametrize("shell", ["bash", "sh"])
def test_activate_gives_a_bare_terminal_everything(bare: dict[str, str], shell: str) -> None:
    # In a plain sh a file cannot know where it is, so it is sourced from the folder of the course.
    commands = [
        ". ./environment/activate.sh",
        *("command -v python", "command -v colcon"),
        *('echo "$AMENT_PREFIX_PATH"', 'echo "$LD_LIBRARY_PATH"', 'echo "$CMAKE_BUILD_TYPE"'),
    ]
    root = Path(sys.prefix).parent
    command = [shell, "-c", "\n".join(commands)]
    done = subprocess.run(command, env=bare, cwd=root, capture_output=True, text=True, check=True)
    python, colcon, prefixes, libraries, build_type = done.stdout.splitlines()
    assert (python, colcon) == (f"{sys.prefix}/bin/python", f"{sys.prefix}/bin/colcon")
    assert prefixes.split(":")[0] == sys.prefix
    assert libraries.split(":")[0] == f"{sys.prefix}/lib"
    assert build_type == "Release"
