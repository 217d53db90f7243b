"""Computes the picture of a robot's way, which ``ways.html.j2`` draws, and says the way in one sentence."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards.readable_text import one_line
from autograder.robot.motion import RADIUS
from autograder.robot.plan import Plan, nose

if TYPE_CHECKING:
    from autograder.verdict import Point, Way

SHOWN = 4
"""The maximum number of ways on a card."""
_WIDTH, _HEIGHT = 400, 270
"""The maximum size of the drawn part of the plane, in pixels."""
_SCALE = 64.0
"""The maximum number of pixels per meter."""
_MARGIN = 12.0
"""Pixels around the drawn part of the plane, for names at its edges."""
_SEEN = "The robot drove", "came", "pushed"
_SUPPOSED = "With the right name, the robot would have driven", "would have come", "would have pushed"
"""The verbs of a way: how the robot drove, and how it would have driven."""


@dataclass(frozen=True)
class WayPicture:
    """The picture of one way. All lengths are in pixels, from the left and from the top.

    Attributes:
        sentence: The way in words.
        walls: The two ends of each wall.
        trail: The points of the way, as SVG takes them.
        start: The place of the start.
        end: The place of the robot at the end.
        turned: The rotation of the robot at the end, in degrees, clockwise.
        radius: The radius of the robot.
        nose: The path of the arrow on the robot.
        bumps: The places at which the robot pushed against a wall.
        places: The places with names.
        names: The names of start, bumps and places, and the position that each stands for.
        below: The distance from such a position to the base line of its name.
    """

    width: float
    height: float
    sentence: str
    walls: tuple[tuple[Point, Point], ...]
    trail: str
    start: Point
    end: Point
    turned: float
    radius: float
    nose: str
    bumps: tuple[Point, ...]
    places: tuple[Point, ...]
    names: tuple[tuple[str, Point], ...]
    below: float


def way_picture(way: Way) -> WayPicture:
    """Lay out one way."""
    drawn = [*way.points, *way.places.values(), *(end for wall in way.walls for end in wall)]
    (left, right), (low, top) = ((min(numbers), max(numbers)) for numbers in zip(*drawn, strict=True))
    wide, high = right - left + 2 * RADIUS, top - low + 2 * RADIUS
    scale = min(_SCALE, _WIDTH / wide, _HEIGHT / high)
    plan = Plan(left - RADIUS, top + RADIUS, scale, _MARGIN)
    radius = round(RADIUS * scale, 1)
    named = [("start", way.points[0]), *(("wall!", bump) for bump in way.bumps), *way.places.items()]
    return WayPicture(
        width=round(wide * scale + 2 * _MARGIN),
        height=round(high * scale + 2 * _MARGIN),
        sentence=way_in_words(way),
        walls=tuple((plan.at(one), plan.at(other)) for one, other in way.walls),
        trail=" ".join(f"{x},{y}" for x, y in map(plan.at, way.points)),
        start=plan.at(way.points[0]),
        end=plan.at(way.points[-1]),
        turned=round(-math.degrees(way.heading), 1),
        radius=radius,
        nose=nose(radius),
        bumps=tuple(map(plan.at, way.bumps)),
        places=tuple(map(plan.at, way.places.values())),
        names=tuple((one_line(name, 24), plan.at(place)) for name, place in named),
        below=radius + 12,
    )


def way_in_words(way: Way) -> str:
    """Return a way in one sentence."""
    drove, came, pushed = _SUPPOSED if way.supposed else _SEEN
    near = [
        f"it {came} within {min(math.dist(point, place) for point in way.points):.2f} m "
        f"of the place “{one_line(name, 24)}”"
        for name, place in way.places.items()
    ]
    bumps = [f"it {pushed} against a wall at {_at(way.bumps[0])}"] if way.bumps else []
    more = "; " + ", and ".join(near + bumps) if near + bumps else ""
    return f"{drove} {way.length:.1f} m, from {_at(way.points[0])} to {_at(way.points[-1])}{more}."


def _at(point: Point) -> str:
    return f"x = {point[0]:.2f} m, y = {point[1]:.2f} m"
