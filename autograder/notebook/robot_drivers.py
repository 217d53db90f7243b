"""Drives the robot: by the action ``/walk_to``, in the scenes of the labs, and by the arrow keys.

The action and the scenes return a velocity for each simulation step. For the arrow keys, JupyterLab calls
:func:`drive`, and a node publishes the command on ``/cmd_vel``.
"""

from __future__ import annotations

import itertools
import math
import time
from collections import deque
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.task import Future
from small_robot_interfaces.action import WalkTo

from autograder.notebook.nodes.ros_session import is_destroyed
from autograder.robot.motion import FASTEST, FASTEST_TURN, ROOM, STILL, TICK, Velocity, towards

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

    from autograder.robot.motion import Pose


NEAR_ENOUGH = 0.1
"""The distance to the goal, in meters, at which the robot counts as arrived."""
TRIES = 5
"""The number of successive steps with a wall in the way after which the robot gives up."""
FEEDBACK_EVERY = 5
"""The number of simulation steps between two feedback messages."""


class _Ending(Enum):
    ARRIVED = "succeed"
    CANCELED = "canceled"
    GAVE_UP = "abort"


@dataclass
class _Walk:
    goal: Any
    point: tuple[float, float]
    ended: Future
    steps: int = 0
    blocked: int = 0


class WalkToServer:
    """Serves the action ``/walk_to``. The robot walks to one goal at a time: a new goal replaces the earlier one."""

    def __init__(self, node: Node, name: str) -> None:
        self._node = node
        self._walk: _Walk | None = None
        self._pose: Pose | None = None
        self._server = ActionServer(
            node,
            WalkTo,
            name,
            execute_callback=self._execute,
            goal_callback=lambda goal: _answer(goal.x, goal.y),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def next(self, pose: Pose, bumped: bool) -> Velocity | None:
        """Return the velocity for the next step; None if the robot is not walking to a goal.

        Args:
            bumped: True if a wall was in the way in the last step.
        """
        self._pose, walk = pose, self._walk
        if walk is None:
            return None
        distance = math.dist(pose.point, walk.point)
        walk.blocked = walk.blocked + 1 if bumped else 0
        if walk.goal.is_cancel_requested:
            self._end(_Ending.CANCELED)
        elif distance < NEAR_ENOUGH:
            self._end(_Ending.ARRIVED)
        elif walk.blocked >= TRIES:
            self._end(_Ending.GAVE_UP)
        else:
            if walk.steps % FEEDBACK_EVERY == 0:
                walk.goal.publish_feedback(WalkTo.Feedback(distance=distance))
            walk.steps += 1
            return towards(pose, walk.point)
        return None

    def give_up(self) -> None:
        """Abort the current goal, if there is one, because another node drives the robot."""
        self._end(_Ending.GAVE_UP)

    def _end(self, ending: _Ending) -> None:
        if self._walk is not None:
            self._walk.ended.set_result(ending)
            self._walk = None

    async def _execute(self, goal: Any) -> WalkTo.Result:
        self.give_up()
        ended = Future(executor=self._node.executor)
        self._walk = _Walk(goal, (goal.request.x, goal.request.y), ended)
        # Await instead of sleeping, so that the robot keeps moving and cancel requests are received.
        ending = await ended
        getattr(goal, ending.value)()
        x, y = self._pose.point if self._pose is not None else (math.nan, math.nan)
        return WalkTo.Result(arrived=ending is _Ending.ARRIVED, x=x, y=y)


def _answer(x: float, y: float) -> GoalResponse:
    inside = 0 <= x <= ROOM.width and 0 <= y <= ROOM.height
    return GoalResponse.ACCEPT if inside else GoalResponse.REJECT


METERS = 0.1
"""The radius in meters of the arc for the number 1. For any other number, the radius is multiplied by this number."""
_QUARTER = math.pi / 2


class Spiral:
    """A scene in which the robot walks a quarter of a circle for each number in an action's feedback.

    The radius is proportional to the number. So for the Fibonacci sequence the robot walks the Fibonacci spiral.

    Args:
        action_type: The type of the action. The first field of its feedback must be a list of numbers.

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
            self._arc, self._steps = _quarter_circle(METERS * number)
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


CORNERS = tuple(itertools.product((0.0, ROOM.door[0], ROOM.width), (0.0, ROOM.height)))
"""The corners of the two rooms, in meters."""
CORNERS_WANTED = 3
IN_A_CORNER = 1.5
"""The distance in meters from which a corner counts as visited."""


class CornerHunt:
    """A scene in which a student drives the robot, and it says how many corners it has visited."""

    is_over = True

    def __init__(self) -> None:
        self._visited: set[tuple[float, float]] = set()
        self.says = ""

    def next(self, pose: Pose, bumped: bool) -> Velocity | None:
        """Count the corner that the robot is in. Return None: the scene does not drive it."""
        del bumped
        self._visited |= {corner for corner in CORNERS if math.dist(pose.point, corner) < IN_A_CORNER}
        count = len(self._visited)
        self.says = (
            f"{count} of {CORNERS_WANTED} corners" if count < CORNERS_WANTED else "I have seen 3 corners!"
        )
        return None


Scene = Spiral | CornerHunt
"""A scene, which drives the robot step by step until the scene is over."""


KEYBOARD = "keyboard"
"""The name of the node that publishes the commands. ``draw_graph`` shows it next to the robot."""
_DISCOVERY_LIMIT = 1.0
"""Time limit in seconds for discovering the robot. After that, the student gets the message that no robot listens."""


@dataclass(frozen=True)
class _Keyboard:
    node: Node
    publisher: Publisher
    made: float


_keyboard: _Keyboard | None = None


def drive(forward: float, turn: float) -> str:
    """Publish one command on ``/cmd_vel``.

    Args:
        forward: Speed in meters per second.
        turn: Turning speed in radians per second, to the left.

    Returns:
        A message for the student if there is no robot; otherwise an empty text.
    """
    global _keyboard
    if not rclpy.ok():
        return "ROS is not started: run the cell with start_ros() first."
    if _keyboard is None or is_destroyed(_keyboard.node) or not _keyboard.node.context.ok():
        node = rclpy.create_node(KEYBOARD, start_parameter_services=False)
        _keyboard = _Keyboard(node, node.create_publisher(Twist, "/cmd_vel", 10), time.monotonic())
    _keyboard.publisher.publish(Twist(linear=Vector3(x=float(forward)), angular=Vector3(z=float(turn))))
    is_late = time.monotonic() > _keyboard.made + _DISCOVERY_LIMIT
    if is_late and not _keyboard.publisher.get_subscription_count():
        return "No robot listens to /cmd_vel: run the cell with start_robot() again."
    return ""
