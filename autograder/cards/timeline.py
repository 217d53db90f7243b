"""Where everything of the traffic picture goes: pure geometry, drawn by ``traffic.html.j2``.

One picture is one part of the check: a row (lane) for each name on the graph, time from left to right.
Lengths along the time axis are computed for the narrowest picture and given out as percentages, so that a
wider card only gets more room; heights are pixels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards import readable, wording
from autograder.cards.readable import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from autograder.cards.traffic import Part
    from autograder.verdict import Moment

WIDTH = 600
"""Pixels of the narrowest picture in which nothing overlaps; narrower windows scroll."""
HALF_WIDTH = 430
"""The same where a check has many parts, so that a wide card shows two side by side."""

_MARGIN = 10.0
_CHARACTER = 6.7
"""Pixels of one character of the 11-pixel monospaced label font; a lane's name is set one pixel larger."""
_GAP = 14.0
"""Pixels between neighbouring marks, so that what took microseconds still reads in order."""
_SHORTEST = 0.002
"""Seconds that an axis covers at least."""

_FEW, _MANY = 5, 8
"""Moments in a lane up to which labels are long, and beyond which they stay on one level: a calm lane."""
_LEVELS = 4
_LEVEL_HEIGHT = 14
_LANE_HEAD = 8
_LANE_FOOT = 10
_AXIS_HEIGHT = 18


@dataclass(frozen=True)
class Mark:
    """One moment in the picture.

    Attributes:
        x: Per cent of the picture's width.
        y: Pixels from the top.
        direction: As in ``Moment``.
        label: What is written beside the mark; empty where there was no room.
        label_y: The label's base line, pixels from the top.
        to_the_left: Whether the label ends at the mark instead of starting there.
        tooltip: The moment in one sentence.
    """

    x: float
    y: float
    direction: str
    label: str
    label_y: float
    to_the_left: bool
    tooltip: str


@dataclass(frozen=True)
class Lane:
    """One row: its name, the base line of the name and of the row's line (pixels), and its marks."""

    name: str
    name_y: float
    line_y: float
    marks: tuple[Mark, ...]


@dataclass(frozen=True)
class Tick:
    """A tick of the time axis: per cent of the width, its text and its ``text-anchor``."""

    x: float
    text: str
    anchor: str


@dataclass(frozen=True)
class Picture:
    """A whole picture.

    Attributes:
        lanes: Its rows, from the top.
        ticks: The ticks of its time axis.
        axis_y: Pixels from the top down to the axis.
        width: Pixels that it needs at least.
        height: Pixels that it has.
        summary: The picture in words.
        break_x: Where left-out moments belong, per cent; None if there are none.
    """

    lanes: tuple[Lane, ...]
    ticks: tuple[Tick, ...]
    axis_y: float
    width: int
    height: float
    summary: str
    break_x: float | None = None


@dataclass(frozen=True)
class _Flag:
    """A label in its place: a leader ``level`` rows high at ``pole``, text from ``left`` to ``right``."""

    level: int
    pole: float
    left: float
    right: float

    def clear_of(self, other: _Flag) -> bool:
        """Whether the two texts do not touch and neither leader runs through the other's text."""
        if self.level == other.level:
            return self.right + 4 <= other.left or other.right + 4 <= self.left
        upper, lower = (self, other) if self.level > other.level else (other, self)
        return not lower.left - 2 <= upper.pole <= lower.right + 2


def picture(part: Part, width: int = WIDTH) -> Picture:
    """Lay out one part of the traffic.

    Args:
        part: What to draw.
        width: Pixels of the narrowest picture.

    Raises:
        ValueError: ``part`` has no moments.
    """
    moments = part.moments
    if not moments:
        raise ValueError("a part without moments cannot be drawn")
    labels = _labels(part)
    axis = _Axis.through(moments, labels, width)
    xs = _spread([axis.x(moment.t) for moment in moments], labels, width)
    lanes: list[Lane] = []
    top = 0.0
    for name in part.lanes:
        members = [index for index, moment in enumerate(moments) if moment.lane == name]
        lane = _lane(name, top, width, [(moments[i], labels[i], xs[i]) for i in members])
        lanes.append(lane)
        top = lane.line_y + _LANE_FOOT
    return Picture(
        lanes=tuple(lanes),
        ticks=tuple(axis.ticks()),
        axis_y=top,
        height=top + _AXIS_HEIGHT,
        summary=wording.part_in_words(part),
        break_x=_percent((xs[part.after] + xs[part.after + 1]) / 2, width) if part.left_out else None,
        width=width,
    )


def _lane(name: str, top: float, picture_width: int, members: Sequence[tuple[Moment, str, float]]) -> Lane:
    flags = _flags([(label, x) for _, label, x in members])
    text = one_line(name, 60)
    rows = 1 + max((flag.level for flag in flags if flag), default=0)
    name_end = readable.width(text) * (_CHARACTER + 0.7) + 6
    if any(flag.level == rows - 1 and flag.left < name_end for flag in flags if flag):
        rows += 1
    line_y = top + _LANE_HEAD + rows * _LEVEL_HEIGHT + 7
    marks = tuple(
        Mark(
            x=_percent(x, picture_width),
            y=line_y,
            direction=moment.direction,
            label=label if flag else "",
            label_y=line_y - 10 - (flag.level if flag else 0) * _LEVEL_HEIGHT,
            to_the_left=flag is not None and flag.left < flag.pole,
            tooltip=wording.moment_in_words(moment),
        )
        for (moment, label, x), flag in zip(members, flags, strict=True)
    )
    return Lane(text, line_y - 10 - (rows - 1) * _LEVEL_HEIGHT, line_y, marks)


def _flags(members: Sequence[tuple[str, float]]) -> list[_Flag | None]:
    """Give each label of a lane a place, or None where there is none.

    From right to left: an earlier label then rises above the later ones and its leader crosses none of them.
    The first one gets a row of its own where it needs it: the others may be written as its continuation.
    """
    many = len(members) > _MANY
    placed: list[_Flag] = []
    flags: list[_Flag | None] = []
    for index, (label, x) in reversed(list(enumerate(members))):
        levels = (1 if many else _LEVELS) + (index == 0)
        neighbour = members[index - 1][1] if index else 0.0
        flag = _place(x, _length(label), levels, placed, free_left=0.0 if many else x - neighbour)
        if label and flag:
            placed.append(flag)
        flags.append(flag if label else None)
    return flags[::-1]


def _place(
    x: float, length: float, levels: int, placed: Sequence[_Flag], *, free_left: float
) -> _Flag | None:
    """The lowest free place right of ``x``, else the lowest within ``free_left`` pixels left of it."""
    for left in (x, x - length) if length < free_left else (x,):
        for level in range(levels):
            flag = _Flag(level, x, left, left + length)
            if all(flag.clear_of(other) for other in placed):
                return flag
    return None


def _labels(part: Part) -> list[str]:
    """The labels as drawn: short, and in a full lane without the words they share with the one before."""
    counts = {lane: sum(moment.lane == lane for moment in part.moments) for lane in part.lanes}
    before: dict[tuple[str, str], str] = {}
    labels = []
    for moment in part.moments:
        full = counts[moment.lane] > _FEW
        key = (moment.lane, moment.direction)
        label = _continued(before.get(key, ""), moment.label) if full else moment.label
        before[key] = moment.label
        labels.append(one_line(label, 22 if full else 30))
    return labels


def _continued(previous: str, label: str) -> str:
    """``label`` without the words it shares with ``previous``: none at all where both are the same."""
    if label == previous:
        return ""
    shared = next((i for i, (a, b) in enumerate(zip(previous, label, strict=False)) if a != b), len(previous))
    blank = label.rfind(" ", 0, shared)
    return f"…{label[blank + 1 :]}" if blank >= 5 else label


@dataclass(frozen=True)
class _Axis:
    start: float
    end: float
    right: float
    """Where ``end`` is drawn: far enough from the edge for the last label."""
    width: int

    @classmethod
    def through(cls, moments: Sequence[Moment], labels: Sequence[str], width: int) -> _Axis:
        times = [moment.t for moment in moments]
        first, last = min(times), max(times)
        start = 0.0 if 0 <= first <= 2 * (last - first) or first == last >= 0 else first
        end = max(last, start + _SHORTEST)
        room = width - _MARGIN
        right = room
        for moment, label in zip(moments, labels, strict=True):
            share = (moment.t - start) / (end - start)
            if share > 0:
                right = min(right, _MARGIN + (room - _length(label) - 2 * _MARGIN) / share)
        return cls(start, end, right, width)

    def x(self, t: float) -> float:
        return _MARGIN + (t - self.start) / (self.end - self.start) * (self.right - _MARGIN)

    def ticks(self) -> Iterable[Tick]:
        """Round values that cover the axis, also right of the last moment."""
        edge = self.start + (self.width - 3 * _MARGIN) / (self.right - _MARGIN) * (self.end - self.start)
        step = _round_step((edge - self.start) * 100 / self.width)
        short = edge - self.start < 0.1
        decimals = max(0, -math.floor(math.log10(step) + 1e-9) - (3 if short else 0))
        for number in range(math.ceil(self.start / step - 1e-9), math.floor(edge / step + 1e-9) + 1):
            value = number * step
            text = f"{value * 1000:.{decimals}f} ms" if short else f"{value:.{decimals}f} s"
            x = self.x(value)
            yield Tick(_percent(x, self.width), text, "start" if x < _length(text) / 2 else "middle")


def _round_step(step: float) -> float:
    """The next of 1, 2, 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))


def _spread(xs: Sequence[float], labels: Sequence[str], width: int) -> list[float]:
    """Move marks just enough to tell them apart, keeping their order and their labels in the picture."""
    limits = [width - _MARGIN - _length(label) for label in labels]
    # Most of a crowded axis stays true to time, even where marks then overlap.
    gap = min(_GAP, 0.6 * (min(limits) - _MARGIN) / len(xs))
    spread: list[float] = []
    for x in xs:
        spread.append(max(x, spread[-1] + gap) if spread else max(x, _MARGIN))
    for index in range(len(spread) - 1, -1, -1):
        spread[index] = min(spread[index], limits[index])
        if index + 1 < len(spread):
            spread[index] = min(spread[index], spread[index + 1] - gap)
    return spread


def _length(label: str) -> float:
    return 5 + readable.width(label) * _CHARACTER


def _percent(x: float, width: int) -> float:
    return round(100 * x / width, 2)
