"""The robot's node. It obeys ``/cmd_vel``, and publishes the position on ``/odom`` and the laser scan on ``/scan``."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool, Trigger

from autograder.notebook.robot_drivers import WalkToServer
from autograder.robot.motion import ROOM, START, STILL, TICK, Pose, Velocity, move
from autograder.robot.sensors import OBEYS_FOR, SCAN_EVERY, laser_scan, look_around, odometry

if TYPE_CHECKING:
    from autograder.notebook.robot_drivers import Scene


@dataclass(frozen=True)
class RobotState:
    """The robot's visible state at one moment.

    Attributes:
        pose: The pose of the robot.
        velocity: The current velocity of the robot.
        bumped: True if a wall is in the robot's way.
        lamp: True if the robot's lamp is on.
        ranges: The distances to the walls in meters, at equal angles all around, beginning straight ahead and going
            left.
        says: The text of the speech bubble; empty if it has none.
    """

    pose: Pose = START
    velocity: Velocity = STILL
    bumped: bool = False
    lamp: bool = False
    ranges: tuple[float, ...] = ()
    says: str = ""


@dataclass(frozen=True)
class RobotNames:
    """The name of the robot, and the full names of the topic, the action and the service that it obeys."""

    robot: str = "robot"
    obeys: str = "/cmd_vel"
    walks: str = "/walk_to"
    lamp: str = "/lamp"

    @classmethod
    def drawn(cls) -> RobotNames:
        """Draw the names of a robot that the student has not seen."""
        robot = random.choice(("bolt", "mango", "nova", "pixel"))
        words = (("drive", "steer", "wheels"), ("go_to", "travel", "visit"), ("beam", "glow", "shine"))
        return cls(robot, *(f"/{robot}/{random.choice(names)}" for names in words))


class RobotNode(Node):
    """Simulates the robot. Any program on the same ROS domain may drive it: a node, a terminal, another notebook.

    The callbacks run one at a time, so they need no lock.
    """

    def __init__(self, names: RobotNames = RobotNames()) -> None:
        super().__init__(names.robot)
        self.names = names
        self._state = RobotState(ranges=look_around(START, ROOM))
        self._told, self._told_at = STILL, -math.inf
        self._ticks = 0
        self._odometry = self.create_publisher(Odometry, "/odom", 10)
        self._scan = self.create_publisher(LaserScan, "/scan", 10)
        self.create_subscription(Twist, names.obeys, self._obey, 10)
        self.create_service(Trigger, "/reset", self._reset)
        self.create_service(SetBool, names.lamp, self._switch_lamp)
        self._walking = WalkToServer(self, names.walks)
        self._scene: Scene | None = None
        self.create_timer(TICK, self._tick)

    @property
    def state(self) -> RobotState:
        """The current state of the robot. Any thread may read it."""
        return self._state

    def play(self, scene: Scene) -> None:
        """Let a scene drive the robot, instead of an earlier scene. Commands and goals take precedence over it."""
        self._scene = scene

    @property
    def rests(self) -> bool:
        """True if no scene is running and the robot stands still."""
        return (self._scene is None or self._scene.is_over) and self._state.velocity == STILL

    def _obey(self, command: Twist) -> None:
        self._told, self._told_at = Velocity(command.linear.x, command.angular.z), self._seconds()
        self._walking.give_up()

    def _tick(self) -> None:
        before = self._state
        fresh = self._seconds() - self._told_at < OBEYS_FOR
        scene = self._scene.next(before.pose, before.bumped) if self._scene is not None else None
        velocity = self._walking.next(before.pose, before.bumped) or (self._told if fresh else scene or STILL)
        moved = move(before.pose, velocity, TICK, ROOM)
        ranges = before.ranges if moved.pose == before.pose else look_around(moved.pose, ROOM)
        says = self._scene.says if self._scene is not None else ""
        self._state = RobotState(moved.pose, moved.velocity, moved.bumped, before.lamp, ranges, says)
        self._tell(self._state)

    def _tell(self, state: RobotState) -> None:
        now = self.get_clock().now().nanoseconds
        self._odometry.publish(_filled(Odometry(), odometry(state.pose, state.velocity, now)))
        if self._ticks % SCAN_EVERY == 0:
            self._scan.publish(_filled(LaserScan(), laser_scan(state.ranges, now)))
        self._ticks += 1

    def _reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._walking.give_up()
        self._told_at = -math.inf
        self._state = RobotState(lamp=self._state.lamp, ranges=look_around(START, ROOM))
        response.success, response.message = True, "back at the start"
        return response

    def _switch_lamp(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._state = replace(self._state, lamp=request.data)
        response.success, response.message = True, f"the lamp is {'on' if request.data else 'off'}"
        return response

    def _seconds(self) -> float:
        return float(self.get_clock().now().nanoseconds) / 1e9


def _filled(message: Any, fields: Mapping[str, Any]) -> Any:
    """Set fields of a message, nested ones as mappings, and return the message."""
    for name, value in fields.items():
        if isinstance(value, Mapping):
            _filled(getattr(message, name), value)
        else:
            setattr(message, name, value)
    return message
