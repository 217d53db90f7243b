"""Starts and stops the robot and its picture."""

from __future__ import annotations

import math
import time
from collections import deque
from typing import TYPE_CHECKING

from IPython.display import display

from autograder.notebook.nodes.background import replace_named, spin_in_background
from autograder.notebook.nodes.ros_session import start_ros
from autograder.notebook.observing.live_picture import LivePicture
from autograder.notebook.robot.node import RobotNode
from autograder.notebook.robot.picture import RobotPicture
from autograder.notebook.robot.scenes import Spiral, Tour

if TYPE_CHECKING:
    from typing import Any

    from rclpy.node import Node

    from autograder.notebook.robot.node import RobotState

NAME = "robot"
"""The name for ``spin_in_background``, so that a second run of the cell replaces the first robot."""
MINUTES = 30.0
"""The number of minutes for which a picture is kept up to date."""
PERIOD = 0.2
"""Seconds between two pictures if the robot has moved."""
_TRAIL = 150
"""The maximum number of positions in the trail."""
_TRAIL_STEP = 0.08
"""The minimum distance between two positions in the trail, in meters."""
_BUTTON = (
    '<button type="button" class="ros2-course-drive" hidden="hidden" data-commandlinker-command="ros2-course:drive" '
    'data-commandlinker-args="{}">Drive with the arrow keys</button>'
)
"""The HTML of a button. JupyterLab shows it only if the extension of this course is installed."""
LONGEST_WAIT = 20.0
"""The maximum time in seconds for which a cell waits until a scene has ended."""
_LOOK_EVERY = 0.05
_TELEPORT = 0.5
"""A distance in meters that the robot cannot roll between two pictures. If the distance is larger, the robot was reset
to the start.
"""


class LiveRobot:
    """A robot that runs in the background. ``start_robot`` returns this object."""

    def __init__(self) -> None:
        start_ros()
        replace_named(NAME, keep=())
        self._node = RobotNode()
        self._background = spin_in_background(self._node, name=NAME)
        self._picture: LivePicture | None = None

    @property
    def running(self) -> bool:
        """True if the robot is running."""
        return self._background.running

    @property
    def state(self) -> RobotState:
        """The position, motion and laser scan of the robot."""
        return self._node.state

    def show(self) -> None:
        """Show the robot below this cell. An earlier picture stays, but is not updated any more."""
        if self._picture is not None:
            self._picture.stop()
        self._picture = LivePicture(_RobotPictures(self._node), MINUTES)
        self._picture.start()
        if self._picture.running:
            # The button is not a part of the picture, so that it is not redrawn while a student clicks it.
            display({"text/html": _BUTTON, "text/plain": ""}, raw=True)  # type: ignore[no-untyped-call]

    def talk(self, topic: str) -> None:
        """Make the robot roll to the door, and report its position twice a second on a topic of type ``String``."""
        self._node.play(Tour(self._node, topic))

    def walk_numbers(self, action_type: Any, name: str) -> None:
        """Make the robot walk a quarter of a circle for each number that arrives as an action's feedback."""
        self._node.play(Spiral(self._node, action_type, name))

    def wait(self) -> None:
        """Wait until the robot has finished its scene and stands still, at most 20 seconds."""
        deadline = time.monotonic() + LONGEST_WAIT
        while self.running and not self._node.rests and time.monotonic() < deadline:
            time.sleep(_LOOK_EVERY)

    def stop(self) -> None:
        """Destroy the robot's node and stop updating the picture. A second call does nothing."""
        self._background.stop()
        if self._picture is not None:
            self._picture.stop()

    def __repr__(self) -> str:
        """Return one line, shown if this is the last expression of a cell."""
        if self.running:
            return "The robot runs in the background: it listens to /cmd_vel. .stop() ends it."
        return "The robot has stopped: run the cell again that started it."


class _RobotPictures:
    def __init__(self, robot: RobotNode) -> None:
        self.name = "_robot_picture"
        self.period = PERIOD
        self._robot = robot
        self._trail: deque[tuple[float, float]] = deque(maxlen=_TRAIL)
        self._shown = robot.state
        self._robots = 1

    def first(self) -> RobotPicture:
        return RobotPicture(self._shown)

    def next(self, node: Node) -> RobotPicture | None:
        before, known = self._shown, self._robots
        names = [space.rstrip("/") + "/" + name for name, space in node.get_node_names_and_namespaces()]
        self._robots = max(1, names.count(self._robot.get_fully_qualified_name()))
        if self._robot.state == before and self._robots == known:
            return None
        far = self._follow()
        glides = not far and self._shown.pose != before.pose
        start = before.pose if glides else None
        return RobotPicture(self._shown, tuple(self._trail), start, PERIOD, self._robots)

    def last(self) -> RobotPicture:
        """Return the last picture, in which the robot stands still."""
        self._follow()
        return RobotPicture(self._shown, tuple(self._trail))

    def _follow(self) -> bool:
        """Add the robot's position to the trail. Return True if it cannot have rolled there since the last picture."""
        state, before = self._robot.state, self._shown
        far = math.dist(state.pose.point, before.pose.point) > _TELEPORT
        if far:
            self._trail.clear()
        if not self._trail or math.dist(state.pose.point, self._trail[-1]) >= _TRAIL_STEP:
            self._trail.append(state.pose.point)
        self._shown = state
        return far
