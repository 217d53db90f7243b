"""Places the moments of a timeline from left to right: by time, or one after the other if all have the same time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.cards.traffic import TrafficPart

CHARACTER = 6.7
"""The width in pixels of a character of the 11-pixel monospaced label font. Names of lanes use a 12-pixel font."""
MARGIN = 10.0
SHORTEST = 0.002
"""The minimum length of an axis, in seconds."""
TURNS = "one after the other"
"""The label of an axis that does not show seconds."""


@dataclass(frozen=True)
class Tick:
    """A tick of the axis: its distance from the left in pixels, its text, and the text's ``text-anchor``."""

    x: float
    text: str
    anchor: str


@dataclass(frozen=True)
class Axis:
    """Converts a position to pixels: ``start`` is at the left margin, ``end`` at ``right``.

    A position is a time in seconds or, if ``seconds`` is false, the number of a moment.
    """

    start: float
    end: float
    right: float
    width: int
    seconds: bool

    @classmethod
    def of(cls, part: TrafficPart, lengths: Sequence[float], width: int) -> Axis:
        """Return an axis that leaves enough space between each mark and the right edge for the mark's label.

        Args:
            part: The part of the traffic to draw.
            lengths: The length of each moment's label, in pixels.
            width: The width of the picture, in pixels.
        """
        places = places_of(part)
        first, last = min(places), max(places)
        if part.stands_still:
            start, end = 0.0, max(last, 1.0)
        else:
            start = 0.0 if 0 <= first <= 2 * (last - first) else first
            end = max(last, start + SHORTEST)
        room = width - MARGIN
        right = room
        for place, length in zip(places, lengths, strict=True):
            share = (place - start) / (end - start)
            if share > 0:
                right = min(right, MARGIN + (room - length - 2 * MARGIN) / share)
        return cls(start, end, right, width, seconds=not part.stands_still)

    def x(self, place: float) -> float:
        """Return the distance from the left, in pixels, of a position."""
        return MARGIN + (place - self.start) / (self.end - self.start) * (self.right - MARGIN)

    def ticks(self) -> Iterator[Tick]:
        """Yield ticks at round values that cover the axis, including the space to the right of the last moment."""
        if not self.seconds:
            yield Tick(0.0, TURNS, "start")
            return
        edge = self.start + (self.width - 3 * MARGIN) / (self.right - MARGIN) * (self.end - self.start)
        step = round_step((edge - self.start) * 100 / self.width)
        short = edge - self.start < 0.1
        decimals = max(0, -math.floor(math.log10(step) + 1e-9) - (3 if short else 0))
        for number in range(math.ceil(self.start / step - 1e-9), math.floor(edge / step + 1e-9) + 1):
            value = number * step
            text = f"{value * 1000:.{decimals}f} ms" if short else f"{value:.{decimals}f} s"
            x = self.x(value)
            yield Tick(x, text, "start" if x < len(text) * CHARACTER / 2 else "middle")


def places_of(part: TrafficPart) -> list[float]:
    """Return the position of each moment of a part on the axis."""
    if part.stands_still:
        return [float(number) for number in range(len(part.moments))]
    return [moment.t for moment in part.moments]


def round_step(step: float) -> float:
    """Return the next number, at least this large, that is 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))
