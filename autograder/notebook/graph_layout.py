"""Where the boxes and lines of a graph go: in columns, from what gives to what takes.

The steps are those of Sugiyama's layered drawing: turn lines round that would close a circle, give each box
a column behind all that lead to it, put a place holder into each column that a long line crosses, and order
every column so that lines cross little.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

SWEEPS = 16
"""How often the columns are gone through; a few times is enough for graphs of a lab."""

GAP_BESIDE = 24
"""Pixels between two boxes of a column."""


@dataclass(frozen=True)
class Line:
    """An arrow between two boxes, with the boxes and place holders on its way.

    Attributes:
        start: The box it leaves.
        end: The box it points to.
        way: From left to right, the first and last are the two boxes.
        turned: It points to the left.
    """

    start: str
    end: str
    way: tuple[str, ...]
    turned: bool


@dataclass(frozen=True)
class Layout:
    """Boxes in columns.

    Attributes:
        columns: From left to right, each from top to bottom; place holders begin with a space.
        lines: The arrows.
    """

    columns: tuple[tuple[str, ...], ...]
    lines: tuple[Line, ...]


def is_place_holder(name: str) -> bool:
    """Whether it keeps a place free for a line and is no box."""
    return name.startswith(" ")


def lay_out(boxes: list[str], arrows: list[tuple[str, str]]) -> Layout:
    """Place boxes and arrows.

    Args:
        boxes: Their names, each once, none of them beginning with a space.
        arrows: Pairs of names of boxes, from and to.
    """
    turned = _closing_a_circle(boxes, arrows)
    forward = [(b, a) if (a, b) in turned else (a, b) for a, b in arrows]
    column = _columns(boxes, forward)
    table = _Table([[] for _ in range(max(column.values(), default=-1) + 1)])
    for box in boxes:
        table.columns[column[box]].append(box)
    lines = []
    for arrow, (left, right) in zip(arrows, forward, strict=True):
        way = table.connect(left, right, column[left], column[right])
        lines.append(Line(*arrow, way=way, turned=arrow in turned))
    table.order()
    return Layout(tuple(map(tuple, table.columns)), tuple(lines))


def place_beside(layout: Layout, sizes: dict[str, float]) -> dict[str, float]:
    """Where the middle of each box goes in its column, so that most lines are straight. In pixels, from 0.

    Each box is drawn to the mean of its neighbours, as far as the others in its column leave room.

    Args:
        layout: The boxes and lines.
        sizes: How much of its column each box and place holder takes, in pixels.
    """
    neighbours: dict[str, list[str]] = {name: [] for column in layout.columns for name in column}
    for line in layout.lines:
        for a, b in itertools.pairwise(line.way):
            neighbours[a].append(b)
            neighbours[b].append(a)
    place: dict[str, float] = {}
    for column in layout.columns:
        place |= _pushed_apart(column, dict.fromkeys(column, 0.0), sizes)
    for sweep in range(SWEEPS):
        for column in layout.columns if sweep % 2 == 0 else reversed(layout.columns):
            wanted = {
                name: sum(place[other] for other in neighbours[name]) / len(neighbours[name])
                if neighbours[name]
                else place[name]
                for name in column
            }
            place |= _pushed_apart(column, wanted, sizes)
    first = min((place[name] - sizes[name] / 2 for name in place), default=0.0)
    return {name: where - first for name, where in place.items()}


def _pushed_apart(
    column: tuple[str, ...], wanted: dict[str, float], sizes: dict[str, float]
) -> dict[str, float]:
    """The places nearest to the wanted ones, on the whole, where no two boxes overlap."""
    found: dict[str, float] = {}
    edge = -math.inf
    for name in column:
        found[name] = max(wanted[name], edge + GAP_BESIDE + sizes[name] / 2)
        edge = found[name] + sizes[name] / 2
    shift = sum(wanted[name] - found[name] for name in column) / len(column)
    return {name: where + shift for name, where in found.items()}


def _closing_a_circle(boxes: list[str], arrows: list[tuple[str, str]]) -> set[tuple[str, str]]:
    """The arrows that lead back to where a walk along the arrows has come from."""
    targets: dict[str, list[str]] = {box: [] for box in boxes}
    for start, end in arrows:
        targets[start].append(end)
    has_entry = {end for _, end in arrows}
    found: set[tuple[str, str]] = set()
    done: set[str] = set()

    def walk(box: str, path: tuple[str, ...]) -> None:
        for target in targets[box]:
            if target == box or target in path:
                found.add((box, target))
            elif target not in done:
                walk(target, (*path, box))
        done.add(box)

    # Begun at what nothing leads to, the walk goes the way that a reader expects.
    for box in sorted(boxes, key=lambda box: box in has_entry):
        if box not in done:
            walk(box, ())
    return found


def _columns(boxes: list[str], forward: list[tuple[str, str]]) -> dict[str, int]:
    """For each box the length of the longest way to it."""
    sources: dict[str, list[str]] = {box: [] for box in boxes}
    for left, right in forward:
        if left != right:
            sources[right].append(left)
    column: dict[str, int] = {}

    def place(box: str) -> int:
        if box not in column:
            column[box] = max((place(source) + 1 for source in sources[box]), default=0)
        return column[box]

    for box in boxes:
        place(box)
    return column


@dataclass
class _Table:
    columns: list[list[str]]
    neighbours: dict[str, list[str]] = field(default_factory=dict)

    def connect(self, left: str, right: str, first: int, last: int) -> tuple[str, ...]:
        """Put a place holder into each column between two boxes."""
        way = [left]
        for number in range(first + 1, last):
            holder = f" {left} {right} {number}"
            if holder not in self.columns[number]:
                self.columns[number].append(holder)
            way.append(holder)
        way.append(right)
        for a, b in itertools.pairwise(way):
            self.neighbours.setdefault(a, []).append(b)
            self.neighbours.setdefault(b, []).append(a)
        return tuple(way)

    def order(self) -> None:
        """Move each box to the mean height of its neighbours in the column before, and behind, by turns."""
        for sweep in range(SWEEPS):
            rightwards = sweep % 2 == 0
            order = range(1, len(self.columns)) if rightwards else range(len(self.columns) - 2, -1, -1)
            for number in order:
                self._order_column(number, number - 1 if rightwards else number + 1)

    def _order_column(self, number: int, fixed: int) -> None:
        # Relative, so that a column of two is as high as one of five.
        size = max(len(self.columns[fixed]), 1)
        height = {name: (place + 0.5) / size for place, name in enumerate(self.columns[fixed])}
        own = len(self.columns[number])

        def mean(item: tuple[int, str]) -> float:
            place, name = item
            heights = [height[other] for other in self.neighbours.get(name, []) if other in height]
            return sum(heights) / len(heights) if heights else (place + 0.5) / own

        self.columns[number] = [name for _, name in sorted(enumerate(self.columns[number]), key=mean)]
