"""`ros2 interface`: what is in an interface file, with nested types below their fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_runtime.ros2_command.interface_show import nested_type, without_comment
from tests.cases import cases

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable


@pytest.mark.parametrize(
    ("line", "nested"),
    [
        *cases(__file__, "nested_types_are_recognized"),
        ("int32 order", None),
        ("int32[] sequence", None),
        ("string<=10 name", None),
        ("uint8 OK=0", None),
        ("float64 x 1.5", None),
        ("# Point position", None),
        ("", None),
        ("---", None),
    ],
)
def test_nested_types_are_recognized(line: str, nested: str | None) -> None:
    assert nested_type(line, "geometry_msgs") == nested


@pytest.mark.parametrize(("line", "kept"), cases(__file__, "comments_are_taken_off"))
def test_comments_are_taken_off(line: str, kept: str) -> None:
    assert without_comment(line) == kept


def test_show_indents_nested_types_by_tabs(ros2: Callable[..., subprocess.CompletedProcess[str]]) -> None:
    shown = ros2("interface", "show", "std_msgs/msg/Header", "--no-comments")
    assert shown.stdout == "builtin_interfaces/Time stamp\n\tint32 sec\n\tuint32 nanosec\nstring frame_id\n"
    assert shown.returncode == 0


def test_show_keeps_comments_of_the_file_itself(
    ros2: Callable[..., subprocess.CompletedProcess[str]],
) -> None:
    plain = ros2("interface", "show", "geometry_msgs/msg/TwistStamped").stdout
    everything = ros2("interface", "show", "geometry_msgs/msg/TwistStamped", "--all-comments").stdout
    assert plain.startswith("# A twist with reference coordinate frame and timestamp\n")
    assert "\t# " not in plain
    assert "\t# " in everything


def test_show_reads_the_name_from_a_pipe(ros2: Callable[..., subprocess.CompletedProcess[str]]) -> None:
    shown = ros2("interface", "show", "-", stdin="std_msgs/msg/Bool\n")
    assert "bool data" in shown.stdout.splitlines()


@pytest.mark.parametrize(("name", "error"), cases(__file__, "show_says_what_is_wrong"))
def test_show_says_what_is_wrong(
    name: str, error: str, ros2: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    shown = ros2("interface", "show", name)
    assert error in shown.stderr
    assert shown.returncode == 1


def test_list_and_package(ros2: Callable[..., subprocess.CompletedProcess[str]]) -> None:
    package = ros2("interface", "package", "my_robot_interfaces").stdout.splitlines()
    assert sorted(package) == ["my_robot_interfaces/action/Fibonacci", "my_robot_interfaces/srv/AddTwoInts"]
    services = ros2("interface", "list", "-s").stdout.splitlines()
    assert services[0] == "Services:"
    assert "    my_robot_interfaces/srv/AddTwoInts" in services
    assert not any("/msg/" in line for line in services)
    assert ros2("interface", "package", "nothing").returncode == 1


def test_packages_with_interfaces_are_listed_by_kind(
    ros2: Callable[..., subprocess.CompletedProcess[str]],
) -> None:
    every = ros2("interface", "packages").stdout.split()
    actions = ros2("interface", "packages", "--only-actions").stdout.split()
    assert every == sorted(every)
    assert {"std_msgs", "my_robot_interfaces"} <= set(every)
    assert "my_robot_interfaces" in actions
    assert "std_msgs" not in actions
