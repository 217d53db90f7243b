"""The decision which ROS 2 is used, on folders and variables that look like real ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_runtime.ros_flavour import (
    Machine,
    NoRosError,
    Ros,
    decide,
    load,
    save,
    sourced_prefixes,
    with_recorded,
)

if TYPE_CHECKING:
    from pathlib import Path

PC = Machine("Linux", "x86_64", (2, 36), (3, 11))


def installed_ros(prefix: Path) -> Path:
    """Make a folder look like the prefix of an installed ROS 2."""
    (prefix / "share/rclpy").mkdir(parents=True)
    (prefix / "share/rclpy/package.xml").write_text("<package><version>7.1.4</version></package>")
    return prefix


def sourced(prefix: Path, distro: str) -> dict[str, str]:
    """Return the variables of a terminal in which the ROS 2 of a prefix is sourced."""
    return {
        "ROS_DISTRO": distro,
        "AMENT_PREFIX_PATH": str(prefix),
        "LD_LIBRARY_PATH": f"{prefix}/opt/rviz_ogre_vendor/lib:{prefix}/lib:/opt/cuda/lib",
        "PYTHONPATH": f"{prefix}/lib/python3.12/site-packages:/home/me/tools",
        "PATH": f"{prefix}/bin:/usr/bin",
    }


def yes() -> bool:
    return True


def no() -> bool:
    return False


def never() -> bool:
    raise AssertionError("rclpy is only tried for a Jazzy")


def test_nothing_sourced_means_the_wheels() -> None:
    assert decide({"PATH": "/usr/bin"}, PC, never) == Ros("wheels")


def test_a_sourced_jazzy_is_used_with_its_own_folders_only(tmp_path: Path) -> None:
    jazzy = installed_ros(tmp_path / "opt/ros/jazzy")
    ros = decide(sourced(jazzy, "jazzy"), PC, yes)
    assert ros.flavour == "system"
    assert ros.paths == {
        "AMENT_PREFIX_PATH": (str(jazzy),),
        "LD_LIBRARY_PATH": (f"{jazzy}/opt/rviz_ogre_vendor/lib", f"{jazzy}/lib"),
        "PYTHONPATH": (f"{jazzy}/lib/python3.12/site-packages",),
    }
    assert ros.notice == ""


def test_a_robostack_jazzy_is_told_by_its_conda_environment(tmp_path: Path) -> None:
    conda = installed_ros(tmp_path / "envs/ros_env")
    environ = {**sourced(conda, "jazzy"), "CONDA_PREFIX": str(conda)}
    assert decide(environ, PC, yes).flavour == "robostack"
    assert decide({**environ, "CONDA_PREFIX": "/opt/conda"}, PC, yes).flavour == "system"


def test_a_workspace_on_top_is_not_taken_for_ros(tmp_path: Path) -> None:
    jazzy = installed_ros(tmp_path / "opt/ros/jazzy")
    environ = sourced(jazzy, "jazzy")
    environ["AMENT_PREFIX_PATH"] = f"{tmp_path}/ros2_ws/install/my_robot_pkg:{jazzy}"
    assert sourced_prefixes(environ) == [str(jazzy)]
    assert decide(environ, PC, yes).paths["AMENT_PREFIX_PATH"] == (str(jazzy),)


def test_a_jazzy_that_this_python_cannot_import_is_left_out_and_said_so(tmp_path: Path) -> None:
    jazzy = installed_ros(tmp_path / "opt/ros/jazzy")
    ros = decide(sourced(jazzy, "jazzy"), PC, no)
    assert ros.flavour == "wheels"
    assert "cannot import its rclpy" in ros.notice
    assert "PYTHON=" in ros.notice


def test_another_distribution_is_left_out_and_said_so(tmp_path: Path) -> None:
    humble = installed_ros(tmp_path / "opt/ros/humble")
    ros = decide(sourced(humble, "humble"), PC, never)
    assert ros.flavour == "wheels"
    assert "humble is sourced" in ros.notice
    assert ros.paths == {}


def test_a_terminal_of_the_course_itself_is_not_a_sourced_ros(tmp_path: Path) -> None:
    environment = installed_ros(tmp_path / "clone/.venv")
    save(Ros("wheels"), environment)
    environ = {"ROS_DISTRO": "jazzy", "AMENT_PREFIX_PATH": str(environment)}
    assert decide(environ, PC, never) == Ros("wheels")


@pytest.mark.parametrize(
    ("machine", "reason"),
    [
        (Machine("Linux", "aarch64", (2, 36), (3, 11)), "aarch64"),
        (Machine("Darwin", "arm64", None, (3, 12)), "Darwin"),
        (Machine("Linux", "x86_64", (2, 27), (3, 11)), "2.28"),
        (Machine("Linux", "x86_64", None, (3, 12)), "GNU C library"),
        (Machine("Linux", "x86_64", (2, 36), (3, 15)), "this is 3.15"),
    ],
)
def test_where_the_wheels_do_not_run_the_error_says_why_and_what_to_do(machine: Machine, reason: str) -> None:
    with pytest.raises(NoRosError, match=reason) as caught:
        decide({}, machine, never)
    assert "robostack.yml" in str(caught.value)


def test_where_the_wheels_do_not_run_a_sourced_jazzy_still_does(tmp_path: Path) -> None:
    jazzy = installed_ros(tmp_path / "opt/ros/jazzy")
    mac = Machine("Darwin", "arm64", None, (3, 12))
    assert decide(sourced(jazzy, "jazzy"), mac, yes).flavour == "system"


def test_this_machine_can_be_read() -> None:
    assert Machine.here().python >= (3, 11)


def test_the_decision_is_recorded_and_read_again(tmp_path: Path) -> None:
    ros = Ros("system", {"AMENT_PREFIX_PATH": ("/opt/ros/jazzy",), "PYTHONPATH": ("/a", "/b")})
    save(ros, tmp_path)
    assert load(tmp_path) == ros


@pytest.mark.parametrize("content", [None, "", "[]", '{"flavour": "wheels"}', '{"flavour": 1, "paths": 2}'])
def test_a_record_that_cannot_be_read_is_none(tmp_path: Path, content: str | None) -> None:
    if content is not None:
        (tmp_path / "course").mkdir()
        (tmp_path / "course/ros.json").write_text(content)
    assert load(tmp_path) is None


def test_a_set_up_made_with_a_sourced_ros_stays_with_it_where_nothing_is_sourced(tmp_path: Path) -> None:
    jazzy = installed_ros(tmp_path / "opt/ros/jazzy")
    first = decide(sourced(jazzy, "jazzy"), PC, yes)
    later = with_recorded({"PATH": "/usr/bin", "PYTHONPATH": "/home/me/tools"}, first)
    assert later["PYTHONPATH"] == f"{jazzy}/lib/python3.12/site-packages:/home/me/tools"
    assert decide(later, PC, yes) == first


def test_a_ros_sourced_now_wins_over_the_recorded_one(tmp_path: Path) -> None:
    old, new = installed_ros(tmp_path / "old"), installed_ros(tmp_path / "new")
    recorded = decide(sourced(old, "jazzy"), PC, yes)
    environ = sourced(new, "jazzy")
    assert with_recorded(environ, recorded) == environ
