"""The robot's scenes: what it says and where it walks, step by step, and in a kernel with a student's node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from my_robot_interfaces.action import Fibonacci
from small_robot_interfaces.action import WalkTo

from autograder.notebook.robot_drivers import CornerHunt, Scene, Spiral
from autograder.robot.motion import ROOM, START, STILL, TICK, Moved, Pose, move
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable


class FakeNode:
    """Keeps the callback that a scene subscribes with."""

    def create_subscription(
        self, message_type: Any, topic: str, callback: Callable[[Any], None], _: int
    ) -> None:
        self.type, self.topic, self.callback = message_type, topic, callback

    def feed(self, *numbers: int) -> None:
        self.callback(self.type(feedback=Fibonacci.Feedback(partial_sequence=numbers)))


@pytest.fixture
def node() -> FakeNode:
    return FakeNode()


def play(scene: Scene, pose: Pose = START) -> tuple[Moved, int, list[str]]:
    """Play a scene to its end: the last step, how many there were, and what it said in each."""
    moved, steps, said = Moved(pose, STILL), 0, []
    while velocity := scene.next(moved.pose, moved.bumped):
        moved, steps = move(moved.pose, velocity, TICK, ROOM), steps + 1
        said.append(scene.says)
    return moved, steps, said


def test_it_walks_a_quarter_of_a_circle_for_each_number(node: FakeNode) -> None:
    spiral = Spiral(node, Fibonacci, "fibonacci")  # type: ignore[arg-type]
    assert node.topic == "fibonacci/_action/feedback"
    assert spiral.is_over
    node.feed(0, 1, 1)
    node.feed(0, 1, 1, 2)
    assert not spiral.is_over
    moved, _, said = play(spiral)
    assert list(dict.fromkeys(said)) == ["1", "2"]
    # Left of the start by the diameter of two small quarters, and back by the difference of the radii.
    assert moved.pose.point == pytest.approx((START.x - 0.2, START.y), abs=0.01)
    assert moved.pose.heading == pytest.approx(-1.57, abs=0.01)


def test_a_corner_counts_once_and_the_third_one_is_the_end_of_the_hunt() -> None:
    hunt, said = CornerHunt(), []
    for x, y in [(1.0, 2.0), (0.5, 0.5), (0.3, 0.4), (0.5, 3.5), (3.5, 3.5)]:
        assert hunt.next(Pose(x, y, 0.0), bumped=False) is None
        said.append(hunt.says)
    assert said == [*(f"{count} of 3 corners" for count in (0, 1, 1, 2)), "I have seen 3 corners!"]


def test_the_numbers_of_another_goal_begin_anew(node: FakeNode) -> None:
    spiral = Spiral(node, Fibonacci, "fibonacci")  # type: ignore[arg-type]
    for _ in range(2):
        node.feed(0, 1, 1)
        node.feed(0, 1, 1, 2)
        _, steps, _ = play(spiral)
    assert steps
    node.feed(0)
    assert play(spiral)[1] == 0, "0 has no radius"


def test_an_action_without_numbers_is_refused(node: FakeNode) -> None:
    with pytest.raises(TypeError, match=r"WalkTo has no list of numbers .* distance, a double"):
        Spiral(node, WalkTo, "walk_to")  # type: ignore[arg-type]


def test_behind_a_wall_it_walks_no_further(node: FakeNode) -> None:
    spiral = Spiral(node, Fibonacci, "fibonacci")  # type: ignore[arg-type]
    node.feed(0, 1, 1, 2, 3, 5, 8, 13, 2_000_000_000)
    moved, _, said = play(spiral)
    assert moved.bumped
    assert said[-1] == "13"
    assert spiral.is_over
    node.feed(2_000_000_000)
    assert play(spiral)[0].bumped, "an arc of a billion steps takes no more memory than one"


(CELL,) = cases(__file__, "CELLS")


@pytest.mark.ros
def test_it_walks_the_feedback_of_a_students_action(run_cells: Callable[..., list[Any]]) -> None:
    imports = (
        "import time\nfrom rclpy.node import Node\n"
        "from autograder.notebook import start_robot, start_ros\nstart_ros()"
    )
    _, shown = run_cells(imports, CELL)
    spiral = "".join(part.text for part in shown if part.output_type == "stream")
    assert spiral.split() == ["0.8", "2.0"]
