"""Converts places of the robot's world to pixels, for the picture in a notebook and for the one on a card."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.robot.motion import Point


@dataclass(frozen=True)
class Plan:
    """A part of the plane, drawn with x to the right and y up.

    Attributes:
        left: The smallest x, in meters.
        top: The largest y, in meters.
        scale: Pixels per meter.
        margin: Pixels between this part of the plane and the edges of the picture.
    """

    left: float
    top: float
    scale: float
    margin: float

    def at(self, point: Point) -> Point:
        """Return the pixels of a position in meters: from the left and from the top."""
        x, y = (point[0] - self.left) * self.scale, (self.top - point[1]) * self.scale
        return round(self.margin + x, 1), round(self.margin + y, 1)


def nose(radius: float) -> str:
    """Return the path of the arrow on a robot that looks along x, for the robot's radius in pixels."""
    tip, back, side = 0.75 * radius, -0.3 * radius, 0.55 * radius
    return f"M{tip:.1f},0 L{back:.1f},{-side:.1f} L{back:.1f},{side:.1f} z"
