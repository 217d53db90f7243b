"""The action ``/walk_to``: the robot walks to a point, reports the remaining distance, and can be canceled."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.task import Future
from small_robot_interfaces.action import WalkTo

from autograder.notebook.robot.motion import ROOM, towards

if TYPE_CHECKING:
    from rclpy.node import Node

    from autograder.notebook.robot.motion import Pose, Velocity

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


class Walking:
    """Serves the action ``/walk_to``. The robot walks to one goal at a time: a new goal replaces the earlier one.

    Args:
        node: The robot.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._walk: _Walk | None = None
        self._pose: Pose | None = None
        self._server = ActionServer(
            node,
            WalkTo,
            "/walk_to",
            execute_callback=self._execute,
            goal_callback=lambda goal: _answer(goal.x, goal.y),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def next(self, pose: Pose, bumped: bool) -> Velocity | None:
        """Return the velocity for the next step; None if the robot is not walking to a goal.

        Args:
            pose: The pose of the robot.
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
