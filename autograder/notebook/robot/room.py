"""The two rooms in which the robot lives: walls, and a door between them."""

from __future__ import annotations

import math
from dataclasses import dataclass

Point = tuple[float, float]
"""Metres: x to the right, y up; (0, 0) is the lower left corner."""


@dataclass(frozen=True)
class Wall:
    """A straight wall from one point to another."""

    start: Point
    end: Point

    def distance_to(self, point: Point) -> float:
        """Metres from a point to the nearest point of this wall."""
        (x1, y1), (x2, y2) = self.start, self.end
        along = ((point[0] - x1) * (x2 - x1) + (point[1] - y1) * (y2 - y1)) / math.dist(
            self.start, self.end
        ) ** 2
        nearest = min(1.0, max(0.0, along))
        return math.dist(point, (x1 + nearest * (x2 - x1), y1 + nearest * (y2 - y1)))

    def distance_along(self, origin: Point, direction: Point) -> float:
        """Metres from a point in a direction (of length 1) to this wall; infinity where the ray misses it."""
        wall_x, wall_y = self.end[0] - self.start[0], self.end[1] - self.start[1]
        across = direction[0] * wall_y - direction[1] * wall_x
        if abs(across) < 1e-12:
            return math.inf
        to_x, to_y = self.start[0] - origin[0], self.start[1] - origin[1]
        distance = (to_x * wall_y - to_y * wall_x) / across
        on_wall = (to_x * direction[1] - to_y * direction[0]) / across
        return distance if distance >= 0 and 0 <= on_wall <= 1 else math.inf


@dataclass(frozen=True)
class Room:
    """The walls around the robot.

    Attributes:
        width: Metres.
        height: Metres.
        walls: The outer walls and those inside.
        door: The middle of the doorway.
    """

    width: float
    height: float
    walls: tuple[Wall, ...]
    door: Point

    def clearance(self, point: Point) -> float:
        """Metres from a point to the nearest wall."""
        return min(wall.distance_to(point) for wall in self.walls)

    def ranges(self, origin: Point, angles: tuple[float, ...]) -> list[float]:
        """Metres from a point to the first wall at each angle, in radians; 0 looks along x."""
        rays = [(math.cos(angle), math.sin(angle)) for angle in angles]
        return [min(wall.distance_along(origin, ray) for wall in self.walls) for ray in rays]


def _two_rooms() -> Room:
    corners: tuple[Point, ...] = ((0, 0), (6, 0), (6, 4), (0, 4))
    outer = tuple(Wall(corner, corners[(i + 1) % 4]) for i, corner in enumerate(corners))
    beside_the_door = (Wall((4, 0), (4, 1.4)), Wall((4, 2.6), (4, 4)))
    return Room(6.0, 4.0, (*outer, *beside_the_door), door=(4.0, 2.0))


ROOM = _two_rooms()
"""Six by four metres, with a wall at x = 4 and a doorway of 1.2 m in the middle of it."""
