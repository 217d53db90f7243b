"""Computes the layout of the traffic picture, which ``traffic.html.j2`` draws.

A picture shows one part of the check: a row (lane) for each name on the graph, and time from left to right. Marks
that would cover each other are drawn one below the other. Lengths along the time axis are computed for the narrowest
picture and stored as percentages, so that a wider card only gets more space. Heights are in pixels. No label covers
another label or a leader line. If many moments have the same time, the axis shows their order instead of times.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards import card_wording, readable_text
from autograder.cards.readable_text import one_line

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.cards.card_traffic import TrafficPart

WIDTH = 600
"""The width in pixels of the narrowest picture in which nothing overlaps. Narrower windows scroll."""
HALF_WIDTH = 430
"""The same width for a check with many parts. It is small enough for two pictures side by side on a wide card."""

_MANY = 8
"""If a lane has more moments than this, labels that may be left out are drawn on one level only, so that the lane stays
readable.
"""
_LEVELS = 4

_FEW = 5
"""If a lane has more moments than this, its labels are shortened."""
_MARK = 11.0
"""The width of a mark in pixels. Marks that are nearer than this are drawn one below the other."""
_ROWS = 3
"""The maximum number of rows of marks in a lane. Further marks cover each other."""
_LEVEL_HEIGHT = 14
_LANE_HEAD = 8
_LANE_FOOT = 10
_AXIS_HEIGHT = 18
_READING_HEIGHT = 16
"""The height below the axis, in pixels, for the text of the mark under the pointer."""


@dataclass(frozen=True)
class Mark:
    """A mark in the picture, which stands for one moment.

    Attributes:
        x: The distance from the left, in percent of the picture's width.
        y: The distance from the top, in pixels.
        direction: The direction of the moment, as in ``Moment``.
        stray: True if the moment is irrelevant for the task, as in ``Moment``.
        label: The text next to the mark; empty if there was no space.
        label_y: The distance of the label's base line from the top, in pixels.
        tooltip: The moment in one sentence.
    """

    x: float
    y: float
    direction: str
    stray: bool
    label: str
    label_y: float
    tooltip: str


@dataclass(frozen=True)
class Lane:
    """A lane of the picture: its name, the base lines of the name and of the row (in pixels), and its marks.

    ``stray`` is True if the task asks for nothing in this lane, for example on a wrong topic.
    """

    name: str
    name_y: float
    line_y: float
    marks: tuple[Mark, ...]
    stray: bool = False


@dataclass(frozen=True)
class Picture:
    """A whole picture.

    Attributes:
        lanes: The lanes, from top to bottom.
        ticks: The ticks of the axis, with x in percent of the width.
        axis_y: The distance of the axis from the top, in pixels.
        width: The minimum width in pixels.
        height: The height in pixels.
        summary: The content of the picture, in words.
        breaks: The positions at which moments were left out, in percent of the width.
        reading_y: The base line of the text of the mark under the pointer, in pixels from the top.
    """

    lanes: tuple[Lane, ...]
    ticks: tuple[Tick, ...]
    axis_y: float
    width: int
    height: float
    summary: str
    breaks: tuple[float, ...]
    reading_y: float


def picture(part: TrafficPart, width: int = WIDTH) -> Picture:
    """Lay out one part of the traffic.

    Args:
        part: The part to draw. It must have moments.
        width: The width of the narrowest picture, in pixels.
    """
    moments = part.moments
    labels = _labels(part)
    axis = _Axis.of(part, [_length(label) for label in labels], width)
    xs = [axis.x(position) for position in _positions(part)]
    lanes: list[Lane] = []
    bottom = 0.0
    for name in part.lanes:
        members = [index for index, moment in enumerate(moments) if moment.lane == name]
        lane, bottom = _lane(part, name, bottom, width, members, labels, xs)
        lanes.append(lane)
    return Picture(
        lanes=tuple(lanes),
        ticks=tuple(Tick(_percent(tick.x, width), tick.text, tick.anchor) for tick in axis.ticks()),
        axis_y=bottom,
        height=bottom + _AXIS_HEIGHT + _READING_HEIGHT,
        summary=card_wording.part_in_words(part),
        breaks=tuple(_percent((xs[after] + xs[after + 1]) / 2, width) for after in part.gaps),
        width=width,
        reading_y=bottom + _AXIS_HEIGHT + _READING_HEIGHT - 5,
    )


def _lane(
    part: TrafficPart,
    name: str,
    top: float,
    width: int,
    members: Sequence[int],
    labels: Sequence[str],
    xs: Sequence[float],
) -> tuple[Lane, float]:
    """Return one lane, and its lower end: the distance from the top of the picture in pixels."""
    moments = part.moments
    placed = _levels(
        [labels[i] for i in members], [xs[i] for i in members], [moments[i].key for i in members]
    )
    text = one_line(name, 60)
    top_level = max((level for level in placed if level is not None), default=0)
    name_end = readable_text.width(text) * (_CHARACTER_WIDTH + 0.7) + 6
    if any(level == top_level and xs[i] < name_end for i, level in zip(members, placed, strict=True)):
        # The lane's name stands at the left of the top level, and a label there would cover it.
        top_level += 1
    line_y = top + _LANE_HEAD + (top_level + 1) * _LEVEL_HEIGHT + 7
    rows = _rows([xs[i] for i in members])
    marks = tuple(
        Mark(
            x=_percent(xs[i], width),
            y=line_y + row * _MARK,
            direction=moments[i].direction,
            stray=moments[i].stray,
            label=labels[i] if level is not None else "",
            label_y=line_y - 10 - (level or 0) * _LEVEL_HEIGHT,
            tooltip=card_wording.moment_in_words(moments[i], part.when(i)),
        )
        for i, level, row in zip(members, placed, rows, strict=True)
    )
    stray = all(mark.stray for mark in marks)
    name_y = line_y - 10 - top_level * _LEVEL_HEIGHT
    return Lane(text, name_y, line_y, marks, stray), line_y + max(rows) * _MARK + _LANE_FOOT


def _rows(xs: Sequence[float]) -> list[int]:
    """Return, for each mark of a lane, a row in which it covers no other mark; if there is none, the last row."""
    taken = [-1000.0] * _ROWS
    rows = []
    for x in xs:
        row = next((row for row, last in enumerate(taken) if x - last >= _MARK), _ROWS - 1)
        taken[row] = x
        rows.append(row)
    return rows


def _labels(part: TrafficPart) -> list[str]:
    """Return the labels to draw, shortened. In a full lane, words that repeat the previous label are left out."""
    counts = {lane: sum(moment.lane == lane for moment in part.moments) for lane in part.lanes}
    before: dict[tuple[str, str], str] = {}
    labels = []
    for moment in part.moments:
        full = counts[moment.lane] > _FEW and not moment.key
        way = (moment.lane, moment.direction)
        label = _continued(before.get(way, ""), moment.label) if full else moment.label
        before[way] = moment.label
        labels.append(readable_text.label(label, 22 if full else 30))
    return labels


def _continued(previous: str, label: str) -> str:
    """Return ``label`` without its first words that ``previous`` has, too; empty if both are equal."""
    if label == previous:
        return ""
    shared = next((i for i, (a, b) in enumerate(zip(previous, label, strict=False)) if a != b), len(previous))
    blank = label.rfind(" ", 0, shared)
    return f"…{label[blank + 1 :]}" if blank >= 5 else label


def _percent(x: float, width: int) -> float:
    return round(100 * x / width, 2)


def _length(label: str) -> float:
    """Return the distance in pixels from a mark to the end of its label."""
    return 5 + readable_text.width(label) * _CHARACTER_WIDTH


def _levels(labels: Sequence[str], xs: Sequence[float], needed: Sequence[bool]) -> list[int | None]:
    """Return the level of each label of a lane, 0 for the lowest; None for a label for which there is no space.

    Labels are placed from right to left, each on the lowest level on which it ends before all labels of this level and
    of those above it. So no two labels cover each other, and no leader line crosses a label.

    Args:
        labels: The labels, in order of time; empty for none.
        xs: The distance of each mark from the left, in pixels.
        needed: Whether each label must be shown.
    """
    most = 1 if len(labels) > _MANY else _LEVELS
    begins: list[float] = []  # the left edge of the leftmost label of each level
    found: list[int | None] = [None] * len(labels)
    for index in reversed([index for index, label in enumerate(labels) if label]):
        end = xs[index] + _length(labels[index]) + 4
        level = next((level for level in range(len(begins)) if end <= min(begins[level:])), len(begins))
        # Allow one more level for the first label: the others leave out words that they share with it, so it must be
        # shown if possible.
        if needed[index] or level < most + (index == 0):
            begins[level : level + 1] = [xs[index]]
            found[index] = level
    return found


_CHARACTER_WIDTH = 6.7
"""The width in pixels of a character of the 11-pixel monospaced label font. Names of lanes use a 12-pixel font."""
_MARGIN = 10.0
_SHORTEST = 0.002
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
class _Axis:
    """Converts a position to pixels: ``start`` is at the left margin, ``end`` at ``right``.

    A position is a time in seconds or, if ``seconds`` is false, the number of a moment.
    """

    start: float
    end: float
    right: float
    width: int
    seconds: bool

    @classmethod
    def of(cls, part: TrafficPart, lengths: Sequence[float], width: int) -> _Axis:
        """Return an axis that leaves enough space between each mark and the right edge for the mark's label.

        Args:
            part: The part of the traffic to draw.
            lengths: The length of each moment's label, in pixels.
            width: The width of the picture, in pixels.
        """
        positions = _positions(part)
        first, last = min(positions), max(positions)
        if part.stands_still:
            start, end = 0.0, max(last, 1.0)
        else:
            start = 0.0 if 0 <= first <= 2 * (last - first) else first
            end = max(last, start + _SHORTEST)
        room = width - _MARGIN
        right = room
        for position, length in zip(positions, lengths, strict=True):
            share = (position - start) / (end - start)
            if share > 0:
                right = min(right, _MARGIN + (room - length - 2 * _MARGIN) / share)
        return cls(start, end, right, width, seconds=not part.stands_still)

    def x(self, position: float) -> float:
        """Return the distance from the left, in pixels, of a position."""
        return _MARGIN + (position - self.start) / (self.end - self.start) * (self.right - _MARGIN)

    def ticks(self) -> Iterator[Tick]:
        """Yield ticks at round values that cover the axis, including the space to the right of the last moment."""
        if not self.seconds:
            yield Tick(0.0, TURNS, "start")
            return
        edge = self.start + (self.width - 3 * _MARGIN) / (self.right - _MARGIN) * (self.end - self.start)
        step = _round_step((edge - self.start) * 100 / self.width)
        short = edge - self.start < 0.1
        decimals = max(0, -math.floor(math.log10(step) + 1e-9) - (3 if short else 0))
        for number in range(math.ceil(self.start / step - 1e-9), math.floor(edge / step + 1e-9) + 1):
            value = number * step
            text = f"{value * 1000:.{decimals}f} ms" if short else f"{value:.{decimals}f} s"
            x = self.x(value)
            yield Tick(x, text, "start" if x < len(text) * _CHARACTER_WIDTH / 2 else "middle")


def _positions(part: TrafficPart) -> list[float]:
    """Return the position of each moment of a part on the axis."""
    if part.stands_still:
        return [float(number) for number in range(len(part.moments))]
    return [moment.t for moment in part.moments]


def _round_step(step: float) -> float:
    """Return the next number, at least this large, that is 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))
