"""The way of the robot through each world of a mission, which the card draws."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec

from autograder.robot.motion import RADIUS
from autograder.verdict import Way

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence
    from autograder.kit.mission.moment import Moment
    from autograder.robot.motion import Point

NOTED = "end"
"""The name of the noted event about the end of a mission, which has the ways in its field ``ways``."""
_APART = 0.05
"""The distance in meters between two points of a way, and that a robot must have driven for a picture."""


class Track:
    """Keeps the way of the robot through each world that it enters."""

    def __init__(self) -> None:
        self._ways: list[Way] = []
        self._leg = -1

    def add(self, now: Moment) -> None:
        """Add the place of the robot at a moment."""
        if now.leg != self._leg:
            self._leg = now.leg
            self._ways.append(_begun(now))
        way, here = self._ways[-1], _rounded(now.pose.point)
        is_near = len(way.points) > 1 and math.dist(*way.points[-2:]) < _APART
        points = (*(way.points[:-1] if is_near else way.points), here)
        is_new = now.bumped and all(math.dist(here, bump) > RADIUS for bump in way.bumps)
        bumps = (*way.bumps, here) if is_new else way.bumps
        self._ways[-1] = replace(way, points=points, bumps=bumps, heading=round(now.pose.heading, 2))

    def told(self) -> list[object]:
        """Return the ways as plain data, for a noted event."""
        return [msgspec.to_builtins(way) for way in self._ways]


def _begun(now: Moment) -> Way:
    world = now.world
    walls = tuple((_rounded(wall.start), _rounded(wall.end)) for wall in world.walls.walls)
    places = {name: _rounded(place) for name, place in world.places.items()}
    return Way((_rounded(world.start.point),), world.start.heading, walls, places)


def _rounded(point: Point) -> Point:
    return round(float(point[0]), 2), round(float(point[1]), 2)


def ways(evidence: Evidence) -> tuple[Way, ...]:
    """Return the ways on which a robot was driven in a check; none if the exercise is not a mission."""
    noted = [
        one for part in evidence for event in part.of("noted", NOTED) for one in event.data.get("ways", ())
    ]
    return tuple(way for one in noted if (way := msgspec.convert(one, Way)).length > _APART)
