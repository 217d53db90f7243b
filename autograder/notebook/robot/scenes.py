"""Scenes for the labs: the robot reports its position, or walks an arc for each number in an action's feedback."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any

from std_msgs.msg import String

from autograder.notebook.robot.motion import FASTEST, FASTEST_TURN, STILL, TICK, Velocity, towards
from autograder.notebook.robot.walk_to_action import NEAR_ENOUGH

if TYPE_CHECKING:
    from rclpy.node import Node

    from autograder.notebook.robot.motion import Pose

SAYS_EVERY = 5
"""The number of simulation steps between two messages about the position."""
METRES = 0.1
"""The radius in meters of the arc for the number 1. For any other number, the radius is multiplied by this number."""
_TOUR = ((2.5, 2.4), (3.6, 2.0))
"""The points on the robot's way to the door, in meters."""
_QUARTER = math.pi / 2


class Tour:
    """A scene in which the robot rolls to the door and reports its position on a topic.

    Args:
        node: The robot.
        topic: The topic for the reports, of type ``std_msgs/msg/String``.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self._publisher = node.create_publisher(String, topic, 10)
        self._way = deque(_TOUR)
        self._steps = 0
        self.says = ""

    @property
    def is_over(self) -> bool:
        """True if the robot has arrived, or a wall stopped it."""
        return not self._way

    def next(self, pose: Pose, bumped: bool) -> Velocity | None:
        """Return the velocity for the next step; None at the end. Report the position every fifth step."""
        if bumped:
            self._way.clear()
        if self._way and math.dist(pose.point, self._way[0]) < NEAR_ENOUGH:
            self._way.popleft()
        if not self._way:
            self.says = ""
            return None
        if self._steps % SAYS_EVERY == 0:
            self.says = f"I am at x = {pose.x:.1f} m, y = {pose.y:.1f} m"
            self._publisher.publish(String(data=self.says))
        self._steps += 1
        return towards(pose, self._way[0])


class Spiral:
    """A scene in which the robot walks a quarter of a circle for each number in an action's feedback.

    The radius is proportional to the number. So for the Fibonacci sequence the robot walks the Fibonacci spiral.

    Args:
        node: The robot.
        action_type: The type of the action. The first field of its feedback must be a list of numbers.
        name: The name of the action.

    Raises:
        TypeError: The first field of the feedback is not a list.
    """

    def __init__(self, node: Node, action_type: Any, name: str) -> None:
        self._field, kind = next(iter(action_type.Feedback.get_fields_and_field_types().items()))
        if not kind.startswith("sequence<"):
            raise TypeError(
                f"The feedback of {action_type.__name__} has no list of numbers that the robot could walk, but "
                f"{self._field}, a {kind}. Pass the type of an action such as Fibonacci."
            )
        self._numbers: list[int] = []
        self._left: deque[int] = deque()
        self._arc, self._steps = STILL, 0
        self.says = ""
        # The name and type of the topic are defined in design.ros2.org/articles/actions.html ("Feedback Topic").
        node.create_subscription(
            action_type.Impl.FeedbackMessage,
            f"{name}/_action/feedback",
            self._hear,
            10,
        )

    @property
    def is_over(self) -> bool:
        """True if the robot has walked all numbers that have arrived."""
        return not self._left and not self._steps

    def _hear(self, message: Any) -> None:
        numbers = [int(number) for number in getattr(message.feedback, self._field)]
        known = len(self._numbers)
        self._left += numbers[known if numbers[:known] == self._numbers else 0 :]
        self._numbers = numbers

    def next(self, pose: Pose, bumped: bool) -> Velocity | None:
        """Return the velocity for the next step; None if no number is left. A wall ends the walk."""
        del pose
        if bumped:
            self._left.clear()
            self._steps = 0
        while self._left and not self._steps:
            number = self._left.popleft()
            self.says = str(number)
            self._arc, self._steps = _quarter_circle(METRES * number)
        if not self._steps:
            self.says = ""
            return None
        self._steps -= 1
        return self._arc


def _quarter_circle(radius: float) -> tuple[Velocity, int]:
    """Return the velocity for a quarter of a circle to the left, and the number of simulation steps that it takes."""
    if radius <= 0:
        return STILL, 0
    speed = min(FASTEST, FASTEST_TURN * radius)
    steps = math.ceil(_QUARTER * radius / (speed * TICK))
    turn = _QUARTER / (steps * TICK)
    return Velocity(turn * radius, turn), steps


Scene = Tour | Spiral
"""A scene, which drives the robot step by step until the scene is over."""
