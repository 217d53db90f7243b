"""Lays out a graph's boxes and arrows in columns, from publishers to subscribers.

igraph decides which arrows close a cycle, in which column and order the boxes are, and how a long arrow passes the
columns in between (Sugiyama's layered drawing). This module computes pixels from that. Each arrow begins and ends at
its own point on the edge of a box, so that two arrows in opposite directions can be told apart.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

Point = tuple[float, float]
"""A position or size in pixels: along the main direction of the arrows, and across it."""

SWEEPS = 100
"""The maximum number of passes in which igraph reduces the crossings of arrows."""
GAP_BESIDE = 24
"""Pixels between two boxes in the same column."""
_PORTS = 0.72
"""The fraction of a box's edge, from 0 to 1, that has room for the ends of arrows."""


@dataclass(frozen=True)
class Arrow:
    """A line between two boxes, given by points: the first on the edge of box ``start``, the last on ``end``'s."""

    start: str
    end: str
    points: tuple[Point, ...]


@dataclass(frozen=True)
class GraphLayout:
    """The positions of boxes and arrows, in pixels.

    Attributes:
        centres: The center of each box.
        arrows: The arrows, in the same order as the input.
        extent: The size of the whole layout, along and across.
    """

    centres: Mapping[str, Point]
    arrows: tuple[Arrow, ...]
    extent: Point


def lay_out(sizes: Mapping[str, Point], arrows: Sequence[tuple[str, str]], gap: float) -> GraphLayout:
    """Return the positions of boxes and arrows, with coordinates from 0.

    Args:
        sizes: The size of each box, along and across.
        arrows: Pairs of two boxes: where the arrow begins, and where it ends. Arrows from a box to itself are left out.
        gap: Pixels between two columns.
    """
    import igraph  # imported here, so that only a notebook that draws a graph waits for the import

    boxes = list(sizes)
    drawn = [(a, b) for a, b in dict.fromkeys(arrows) if a != b]
    if not boxes:
        return GraphLayout({}, (), (0.0, 0.0))
    number = {box: index for index, box in enumerate(boxes)}
    edges = [(number[a], number[b]) for a, b in drawn]
    # Reverse the arrows that close a cycle before igraph does, because igraph 1.0 returns wrong routes for arrows that
    # it reverses itself.
    back = set(igraph.Graph(n=len(boxes), edges=edges, directed=True).feedback_arc_set(method="eades"))
    onward = [(b, a) if index in back else (a, b) for index, (a, b) in enumerate(edges)]
    graph = igraph.Graph(n=len(boxes), edges=onward, directed=True)
    found = graph.layout_sugiyama(hgap=1, vgap=1, maxiter=SWEEPS)
    places = [list(place) for place in found.coords]
    routing = [way[::-1] if index in back else way for index, way in enumerate(found.edge_routing)]
    _push_apart([*places, *itertools.chain(*routing)])
    columns = [round(layer) for _, layer in places]
    unit = max(beside for _, beside in sizes.values()) + GAP_BESIDE
    along = _columns(columns, [sizes[box][0] for box in boxes], gap)
    first = min(place for place, _ in (*places, *itertools.chain(*routing)))
    start = max(beside for _, beside in sizes.values()) / 2

    def middle(place: float, layer: float) -> Point:
        return along[round(layer)], (place - first) * unit + start

    centres = {box: middle(*places[index]) for box, index in number.items()}
    ways = [
        [centres[a], *(middle(*point) for point in routed), centres[b]]
        for (a, b), routed in zip(drawn, routing, strict=True)
    ]
    extent = (
        max(centres[box][0] + sizes[box][0] / 2 for box in boxes),
        max(beside for way in (*ways, [*centres.values()]) for _, beside in way) + start,
    )
    return GraphLayout(centres, _with_ports(drawn, ways, sizes), extent)


def _push_apart(places: Sequence[list[float]]) -> None:
    """Move the boxes of a column at least one unit apart, because igraph does not always keep this distance."""
    last: dict[int, float] = {}
    for place in sorted(places):
        column = round(place[1])
        place[0] = max(place[0], last.get(column, place[0] - 1) + 1)
        last[column] = place[0]


def _columns(columns: Sequence[int], widths: Sequence[float], gap: float) -> list[float]:
    """Return the center of each column. A column is as wide as its widest box."""
    middles = []
    edge = 0.0
    for column in range(max(columns) + 1):
        width = max((w for c, w in zip(columns, widths, strict=True) if c == column), default=0.0)
        middles.append(edge + width / 2)
        edge += width + gap
    return middles


def _with_ports(
    drawn: Sequence[tuple[str, str]], ways: Sequence[list[Point]], sizes: Mapping[str, Point]
) -> tuple[Arrow, ...]:
    """Return the arrows, with their ends spread along the edges of the boxes so that arrows cross less."""
    ends: dict[tuple[str, bool], list[tuple[float, int, bool]]] = {}
    for index, ((a, b), way) in enumerate(zip(drawn, ways, strict=True)):
        onward = way[-1][0] > way[0][0]
        ends.setdefault((a, onward), []).append((way[1][1], index, True))
        ends.setdefault((b, not onward), []).append((way[-2][1], index, False))
    ports: dict[tuple[int, bool], Point] = {}
    for (box, after), there in ends.items():
        width, height = sizes[box]
        for place, (_, index, leaves) in enumerate(sorted(there)):
            centre = ways[index][0 if leaves else -1]
            share = (place + 1) / (len(there) + 1) - 0.5
            ports[index, leaves] = (
                centre[0] + (width / 2 if after else -width / 2),
                centre[1] + share * height * _PORTS,
            )
    return tuple(
        Arrow(a, b, (ports[index, True], *ways[index][1:-1], ports[index, False]))
        for index, (a, b) in enumerate(drawn)
    )
