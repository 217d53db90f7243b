"""The robot in a kernel: its picture follows it, and a second run of the cell takes the place of the first."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

START = cases(__file__, "START")

pytestmark = pytest.mark.ros


@pytest.fixture
def run(run_cells: Callable[..., list[Any]]) -> Callable[..., list[Any]]:
    """Run cells below START; what each shows in the end."""
    return lambda *sources: run_cells(START, *sources)[1:]


def words(outputs: Any) -> str:
    """The one picture, in words; the button below it has none."""
    shown = (output.data["text/plain"] for output in outputs if output.output_type == "display_data")
    (picture,) = filter(None, shown)
    return str(picture)


def test_the_picture_follows_the_robot_until_it_stops(run: Callable[..., list[Any]]) -> None:
    (outputs,) = run("robot = start_robot()\ndrive(robot)\nrobot.stop()")
    assert "x = 1.00 m" not in words(outputs)
    assert "It stands still." in words(outputs)


def test_a_stranger_obeys_only_the_names_that_were_drawn_for_it(run: Callable[..., list[Any]]) -> None:
    _, (found,) = run(
        "robot = start_robot(stranger=True)\nlooking = Node('looking')",
        "until(lambda: any('Twist' in str(kinds) for _, kinds in looking.get_topic_names_and_types()))\n"
        "print([name for name, kinds in looking.get_topic_names_and_types() if 'Twist' in str(kinds)])\n"
        "robot.stop()",
    )
    assert "/cmd_vel" not in found.text
    assert found.text.count("/") == 2


def test_a_second_run_of_the_cell_begins_anew_and_says_nothing_of_the_first(
    run: Callable[..., list[Any]],
) -> None:
    cell = "robots = [*globals().get('robots', ()), start_robot()]"
    _, again, said = run(
        cell, cell, "print(robots[0].running, robots[1].running, robots[0]); robots[1].stop()"
    )
    assert "x = 1.00 m" in words(again)
    assert {output.output_type for output in again} == {"display_data"}
    assert said[0].text == "False True The robot has stopped: run the cell again that started it.\n"


def test_shown_again_the_picture_above_rests(run: Callable[..., list[Any]]) -> None:
    above, below, third, _ = run(
        "robot = start_robot()", "robot.show(); drive(robot)", "robot.show(); drive(robot)", "robot.stop()"
    )
    assert "x = 1.00 m" in words(above)
    assert "x = 1.00 m" not in words(below)
    assert words(third) != words(below), "each picture rests where the next one begins"


def test_the_keyboard_is_a_node_that_drives(run: Callable[..., list[Any]]) -> None:
    (_, said) = run(
        "robot = start_robot()\nfrom autograder.notebook import robot_drivers as keyboard",
        """
while robot.state.pose.x < 1.2:
    assert keyboard.drive(0.5, 0.0) == ""
    time.sleep(0.1)
assert "keyboard" in keyboard._keyboard.node.get_node_names()
robot.stop()
until(lambda: keyboard.drive(0.5, 0.0))
print(keyboard.drive(0.5, 0.0))
import rclpy
rclpy.shutdown()
print(keyboard.drive(0.5, 0.0))
""",
    )
    assert [line for output in said for line in output.text.splitlines()] == [
        "No robot listens to /cmd_vel: run the cell with start_robot() again.",
        "ROS is not started: run the cell with start_ros() first.",
    ]
