"""Computes the motion of the robot between walls: the robot turns, rolls forward, and stops at a wall."""

from __future__ import annotations

import math
from collections.abc import Sequence  # noqa: TC003  (an author reads the types)
from dataclasses import dataclass, replace

Point = tuple[float, float]
"""A position in meters, x to the right and y up. (0, 0) is the lower left corner."""
TICK = 0.1
"""Seconds between two simulation steps, and between two messages on ``/odom``."""
RADIUS = 0.2
"""The radius of the robot in meters."""
FASTEST = 1.0
"""The maximum speed in meters per second."""
FASTEST_TURN = 2.0
"""The maximum turning speed in radians per second."""
_STEP = 0.05
"""The distance in meters that the robot rolls between two tests for a wall."""


@dataclass(frozen=True)
class Wall:
    """A straight wall from one point to another; a post, which the laser does not see, if both are the same."""

    start: Point
    end: Point

    def distance_to(self, point: Point) -> float:
        """Return the distance in meters from a point to the nearest point of this wall."""
        (x1, y1), (x2, y2) = self.start, self.end
        # A wall of length 0 is a post. Every part of it is its start.
        squared = math.dist(self.start, self.end) ** 2 or 1.0
        along = ((point[0] - x1) * (x2 - x1) + (point[1] - y1) * (y2 - y1)) / squared
        nearest = min(1.0, max(0.0, along))
        return math.dist(point, (x1 + nearest * (x2 - x1), y1 + nearest * (y2 - y1)))

    def distance_along(self, origin: Point, direction: Point) -> float:
        """Return the distance in meters from a point to this wall in a direction of length 1; infinity for a miss."""
        wall_x, wall_y = self.end[0] - self.start[0], self.end[1] - self.start[1]
        across = direction[0] * wall_y - direction[1] * wall_x
        if abs(across) < 1e-12:
            return math.inf
        to_x, to_y = self.start[0] - origin[0], self.start[1] - origin[1]
        distance = (to_x * wall_y - to_y * wall_x) / across
        on_wall = (to_x * direction[1] - to_y * direction[0]) / across
        return distance if distance >= 0 and 0 <= on_wall <= 1 else math.inf


@dataclass(frozen=True)
class Walls:
    """The walls around the robot.

    Attributes:
        walls: The outer and the inner walls, and posts; empty for an open plane.
        width: The width of both rooms together, in meters.
        height: The height of the rooms on the map, in meters.
        door: The center of the doorway between the rooms.
    """

    walls: Sequence[Wall] = ()
    width: float = 6.0
    height: float = 4.0
    door: Point = (4.0, 2.0)

    def clearance(self, point: Point) -> float:
        """Return the distance in meters from a point to the nearest wall."""
        return min((wall.distance_to(point) for wall in self.walls), default=math.inf)

    def ranges(self, origin: Point, angles: tuple[float, ...]) -> list[float]:
        """Return the distance in meters from a point to the first wall at each angle (in radians from the x axis)."""
        rays = [(math.cos(angle), math.sin(angle)) for angle in angles]
        return [
            min((wall.distance_along(origin, ray) for wall in self.walls), default=math.inf) for ray in rays
        ]


def _two_rooms() -> Walls:
    corners: tuple[Point, ...] = ((0, 0), (6, 0), (6, 4), (0, 4))
    outer = tuple(Wall(corner, corners[(i + 1) % 4]) for i, corner in enumerate(corners))
    beside_the_door = (Wall((4, 0), (4, 1.4)), Wall((4, 2.6), (4, 4)))
    return Walls((*outer, *beside_the_door))


ROOM = _two_rooms()
"""The robot's two rooms: six by four meters, with a wall at x = 4 m that has a doorway of 1.2 m in its middle."""


@dataclass(frozen=True)
class Pose:
    """The position of the robot in meters, and the heading in radians, counterclockwise from the x axis."""

    x: float
    y: float
    heading: float

    @property
    def point(self) -> tuple[float, float]:
        """The center of the robot."""
        return self.x, self.y


START = Pose(1.0, 2.0, 0.0)
"""The pose at the start, in which the robot faces the door."""


@dataclass(frozen=True)
class Velocity:
    """A velocity: meters per second forward, radians per second to the left, and meters per second to the left.

    Only a robot that can move in all directions (Twist's ``linear.y``) moves to the left.
    """

    forward: float = 0.0
    turn: float = 0.0
    left: float = 0.0


STILL = Velocity()


@dataclass(frozen=True)
class Moved:
    """The result of one step of movement.

    Attributes:
        pose: The pose after the step.
        velocity: The actual velocity. Its forward speed is 0 if a wall is in the way.
        bumped: True if a wall is in the way.
    """

    pose: Pose
    velocity: Velocity
    bumped: bool = False


def move(pose: Pose, velocity: Velocity, seconds: float, room: Walls) -> Moved:
    """Return the pose and velocity of the robot after turning and rolling for some seconds. A wall stops it."""
    # The motors limit both speeds.
    speed = Velocity(
        _limited(velocity.forward, FASTEST),
        _limited(velocity.turn, FASTEST_TURN),
        _limited(velocity.left, FASTEST),
    )
    pieces = max(1, math.ceil(math.hypot(speed.forward, speed.left) * seconds / _STEP))
    here = pose
    for _ in range(pieces):
        turned = here.heading + speed.turn * seconds / pieces
        # Roll in the direction halfway between the old and the new heading, so that a circle stays a circle.
        heading, part = (here.heading + turned) / 2, seconds / pieces
        x = part * (speed.forward * math.cos(heading) - speed.left * math.sin(heading))
        y = part * (speed.forward * math.sin(heading) + speed.left * math.cos(heading))
        there = Pose(here.x + x, here.y + y, _wrapped(turned))
        clearance = room.clearance(there.point)
        if (x or y) and clearance < RADIUS and clearance < room.clearance(here.point):
            return Moved(replace(here, heading=there.heading), Velocity(0.0, speed.turn), bumped=True)
        here = there
    return Moved(here, speed)


def _limited(value: float, limit: float) -> float:
    """Return a value between the limit and its negative; 0 if the value is NaN."""
    return 0.0 if math.isnan(value) else min(limit, max(-limit, value))


def towards(pose: Pose, goal: tuple[float, float]) -> Velocity:
    """Return the velocity for the next step on the way to a point: first turn, then roll."""
    off = _wrapped(math.atan2(goal[1] - pose.y, goal[0] - pose.x) - pose.heading)
    if abs(off) > 0.3:
        return Velocity(0.0, math.copysign(1.2, off))
    return Velocity(0.5, 1.5 * off)


def _wrapped(angle: float) -> float:
    return math.remainder(angle, math.tau)
