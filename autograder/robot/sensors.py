"""The messages of the robot: their fields on ``/odom`` and ``/scan``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from autograder.robot.motion import TICK

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.robot.motion import Pose, Velocity, Walls

SCAN_EVERY = 5
"""The number of steps between two messages on ``/scan``."""
OBEYS_FOR = 1.0
"""Seconds for which the robot obeys a command. If no other command arrives by then, it stops."""
RAYS = 36
"""The number of distances in a laser scan, all around the robot."""
FARTHEST = 10.0
"""The range of the laser, in meters."""


def look_around(pose: Pose, walls: Walls) -> tuple[float, ...]:
    """Return the distances to the walls in meters, at equal angles all around, from straight ahead to the left."""
    angles = tuple(pose.heading + math.tau * ray / RAYS for ray in range(RAYS))
    return tuple(min(FARTHEST, distance) for distance in walls.ranges(pose.point, angles))


def odometry(pose: Pose, velocity: Velocity, nanoseconds: int) -> dict[str, Any]:
    """Return the fields of a nav_msgs/msg/Odometry."""
    turned = {"z": math.sin(pose.heading / 2), "w": math.cos(pose.heading / 2)}
    speed = {"linear": {"x": velocity.forward, "y": velocity.left}, "angular": {"z": velocity.turn}}
    return {
        "header": _header("odom", nanoseconds),
        "child_frame_id": "base_link",
        "pose": {"pose": {"position": {"x": pose.x, "y": pose.y}, "orientation": turned}},
        "twist": {"twist": speed},
    }


def laser_scan(ranges: Sequence[float], nanoseconds: int) -> dict[str, Any]:
    """Return the fields of a sensor_msgs/msg/LaserScan with these distances in meters."""
    return {
        "header": _header("base_link", nanoseconds),
        "angle_min": 0.0,
        "angle_max": math.tau * (RAYS - 1) / RAYS,
        "angle_increment": math.tau / RAYS,
        "scan_time": TICK * SCAN_EVERY,
        "range_min": 0.05,
        "range_max": FARTHEST,
        "ranges": list(ranges),
    }


def _header(frame: str, nanoseconds: int) -> dict[str, Any]:
    return {
        "stamp": {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9},
        "frame_id": frame,
    }
