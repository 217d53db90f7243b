"""The motion of the robot: it turns, it rolls forward, and it stops at a wall."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.notebook.robot.room import Room

TICK = 0.1
"""Seconds between two steps, and between two messages on ``/odom``."""
RADIUS = 0.2
"""Metres."""
FASTEST = 1.0
"""Metres per second; a faster command is cut."""
FASTEST_TURN = 2.0
"""Radians per second."""
_STEP = 0.05
"""Metres that are rolled between two looks for a wall."""


@dataclass(frozen=True)
class Pose:
    """The place of the robot: metres, and radians to the left of the x axis."""

    x: float
    y: float
    heading: float

    @property
    def point(self) -> tuple[float, float]:
        """Its centre."""
        return self.x, self.y


START = Pose(1.0, 2.0, 0.0)
"""It looks at the door."""


@dataclass(frozen=True)
class Velocity:
    """The command to the robot: metres per second forward, radians per second to the left."""

    forward: float = 0.0
    turn: float = 0.0

    def within_limits(self) -> Velocity:
        """The command within the motors' limits; no movement for what is no number."""
        return Velocity(_limited(self.forward, FASTEST), _limited(self.turn, FASTEST_TURN))


STILL = Velocity()


def _limited(value: float, limit: float) -> float:
    return 0.0 if math.isnan(value) else min(limit, max(-limit, value))


@dataclass(frozen=True)
class Moved:
    """One step of a movement.

    Attributes:
        pose: Where it is now.
        velocity: What it really did: nothing forward where a wall is in the way.
        bumped: Whether a wall is in the way.
    """

    pose: Pose
    velocity: Velocity
    bumped: bool = False


def move(pose: Pose, velocity: Velocity, seconds: float, room: Room) -> Moved:
    """Turn and roll for some seconds, no further than the first wall."""
    speed = velocity.within_limits()
    pieces = max(1, math.ceil(abs(speed.forward) * seconds / _STEP))
    here = pose
    for _ in range(pieces):
        turned = here.heading + speed.turn * seconds / pieces
        # Half of the turn before, half of it after: a circle stays a circle.
        way, heading = speed.forward * seconds / pieces, (here.heading + turned) / 2
        there = Pose(here.x + way * math.cos(heading), here.y + way * math.sin(heading), _wrapped(turned))
        clearance = room.clearance(there.point)
        if way and clearance < RADIUS and clearance < room.clearance(here.point):
            return Moved(replace(here, heading=there.heading), Velocity(0.0, speed.turn), bumped=True)
        here = there
    return Moved(here, speed)


def towards(pose: Pose, goal: tuple[float, float]) -> Velocity:
    """The next command on the way to a point: turn first, then roll."""
    off = _wrapped(math.atan2(goal[1] - pose.y, goal[0] - pose.x) - pose.heading)
    if abs(off) > 0.3:
        return Velocity(0.0, math.copysign(1.2, off))
    return Velocity(0.5, 1.5 * off)


def _wrapped(angle: float) -> float:
    return math.remainder(angle, math.tau)
