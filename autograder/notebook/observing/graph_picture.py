"""Draws the running graph, once or live: nodes, and the topics, services and actions between them.

The picture is SVG, with a description in words for readers who cannot see it. JupyterLab's theme does not apply inside
the picture. So in a dark theme, the light picture is shown with inverted brightness.

Boxes and arrows are laid out in columns, from publishers to subscribers. igraph decides which arrows close a cycle, in
which column and order the boxes are, and how a long arrow passes the columns in between (Sugiyama's layered drawing).
This module computes pixels from that. Each arrow begins and ends at its own point on the edge of a box, so that two
arrows in opposite directions can be told apart.
"""

from __future__ import annotations

import itertools
import time
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING

from autograder.notebook.observing.live_picture import LivePicture, as_image, svg_page
from autograder.notebook.observing.ros_graph import (
    ChannelKind,
    GraphChannel,
    RosGraph,
    TopicTraffic,
    graph_known_to,
    read_graph,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rclpy.node import Node


Point = tuple[float, float]
"""A position or size in pixels: along the main direction of the arrows, and across it."""

PERIOD = 1.0
"""Seconds between two queries of the graph."""
AGAIN = 10.0
"""Seconds after which a picture with moving lines is shown again, even without a change. The animation lasts only a
little longer, so the lines stop soon after the kernel has ended.
"""
_DARK = '<style>[data-jp-theme-light="false"] .ros-graph { filter: invert(0.93) hue-rotate(180deg); }</style>'
"""A style for JupyterLab's dark theme, which inverts the brightness and keeps the hues."""

# Pixels.
_LETTER = 7.3
_PADDING = 14
_HEIGHT = 46
_GAP_ALONG = 52
_GAP_ALONG_DOWN = 34
_MARGIN = 12
_PAGE = 860
"""The width of a notebook's column in pixels. A picture that would be wider from left to right is drawn from top to
bottom, if this makes it narrower.
"""

_STYLE = """
.ground { fill: #fff; }
text { font: 13px/1 monospace; fill: #212121; text-anchor: middle; dominant-baseline: central; }
text.type { font-size: 12px; fill: #3a3a3a; }
.box rect { fill: #fff; stroke: #212121; }
.node rect { fill: #e8eef7; stroke-width: 2; }
.service rect { stroke-dasharray: 5 3; }
.action rect { stroke-dasharray: 1.5 2.5; }
path.line { fill: none; stroke: #555; stroke-width: 1.5; }
path.head { fill: #555; }
text.rate { font-size: 10.5px; fill: #0b5cad; paint-order: stroke; stroke: #fff; stroke-width: 4px; text-anchor: end; }
path.flows { stroke: #0b5cad; stroke-dasharray: 7 5; animation: flow 0.8s linear 16; }
@keyframes flow { to { stroke-dashoffset: -12; } }
@media (prefers-reduced-motion: reduce) { path.flows { animation: none; } }
"""


def draw_graph() -> GraphPicture:
    """Return a picture of the running graph. A notebook shows it if this is the last expression of a cell.

    The picture shows every node of this kernel's ROS domain, including nodes of other programs. It leaves out the
    endpoints that every node has, such as those for its log and parameters.
    """
    return GraphPicture(read_graph())


def watch_graph(minutes: float = 10.0) -> LivePicture:
    """Show the running graph below this cell, and draw it again as nodes come and go.

    The lines of a topic with messages move, and each topic shows its rate. The picture is drawn again until the time is
    over, the cell or another ``watch_graph`` is run, the kernel's nodes are stopped, or ROS is shut down. The last
    picture stays. To count messages, a hidden node subscribes to each topic, so ``ros2 topic info`` shows one more
    subscription meanwhile.

    Args:
        minutes: The number of minutes for which the picture is drawn again.

    Raises:
        ValueError: ``minutes`` is not a positive number.
    """
    watch = LivePicture(_GraphPictures(), minutes)
    watch.start()
    return watch


@dataclass(frozen=True, repr=False)
class GraphPicture:
    """A picture of the graph. JupyterLab shows an image, and other front ends the same content as text.

    Attributes:
        graph: The nodes and their connections.
        rates: The number of messages per second on each topic, if it is known.
    """

    graph: RosGraph
    rates: Mapping[GraphChannel, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        """Return the graph in words."""
        return "\n".join(self.sentences())

    def _repr_html_(self) -> str:
        sentences = self.sentences()
        words = f"The running graph. {' '.join(sentences)}"
        image = as_image(self.svg(), words, 'class="ros-graph"')
        items = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
        return f"{_DARK}{image}<details><summary>The graph in words</summary><ul>{items}</ul></details>"

    def svg(self) -> str:
        """Return the picture as SVG, with the description in words."""
        labels = {_node_key(node): _Label("node", node) for node in self.graph.nodes}
        labels |= {_channel_key(c): _Label(c.kind, c.name, c.type) for c in self.graph.channels}
        rates = {_channel_key(channel): f"{rate:g}/s" for channel, rate in self.rates.items() if rate}
        # An arrow shows the direction of messages, requests and goals: from a publisher or client to the topic, service
        # or action, or from there to a subscriber or server.
        arrows = []
        for end in self.graph.ends:
            node, channel = _node_key(end.node), _channel_key(end.channel)
            arrows.append((node, channel) if end.gives else (channel, node))
        return _Drawing(labels, arrows, rates, " ".join(self.sentences())).svg()

    @property
    def is_moving(self) -> bool:
        """True if a line of the picture moves, because messages arrive on a topic."""
        return any(self.rates.values())

    def sentences(self) -> list[str]:
        """Return the graph in words, one sentence for each node and for each topic with traffic."""
        moving = [
            f"{channel.name} carries {rate:g} messages per second."
            for channel, rate in self.rates.items()
            if rate
        ]
        return [*self.graph.sentences(), *moving]


class _GraphPictures:
    def __init__(self) -> None:
        self.name = "_graph_watch"
        self.period = PERIOD
        self._traffic: TopicTraffic | None = None
        self._shown_at = time.monotonic()

    def first(self) -> GraphPicture:
        self._shown = draw_graph()
        return self._shown

    def next(self, node: Node) -> GraphPicture | None:
        self._traffic = self._traffic or TopicTraffic(node)
        graph = graph_known_to(node)
        picture = GraphPicture(graph, self._traffic.rates(graph.channels))
        old = picture.is_moving and time.monotonic() > self._shown_at + AGAIN
        if picture == self._shown and not old:
            return None
        self._shown, self._shown_at = picture, time.monotonic()
        return picture

    def last(self) -> GraphPicture | None:
        """Return the last picture, in which no line moves."""
        return GraphPicture(self._shown.graph) if self._shown.is_moving else None


@dataclass(frozen=True)
class _Label:
    shape: str
    name: str
    type: str = ""

    @property
    def small_print(self) -> str:
        """The small second line of text in a box."""
        return self.type if self.shape in (ChannelKind.TOPIC, "node") else f"{self.shape}: {self.type}"

    @property
    def width(self) -> float:
        """The width of the box, in pixels."""
        return max(len(self.name) * 1.1, len(self.small_print)) * _LETTER + 2 * _PADDING


def _node_key(node: str) -> str:
    return f"node {node}"


def _channel_key(channel: GraphChannel) -> str:
    return f"{channel.kind} {channel.name} {channel.type}"


class _Drawing:
    """Computes the layout of a graph and draws it as SVG.

    Arrows go to the right, or downward if the picture would be too wide. In this class, ``along`` is the coordinate in
    the direction of the arrows, and ``beside`` the other coordinate.
    """

    def __init__(
        self,
        labels: Mapping[str, _Label],
        arrows: Sequence[tuple[str, str]],
        rates: Mapping[str, str],
        words: str,
    ) -> None:
        self._labels = labels
        self._rates = rates
        self._words = words
        self._down = False
        self._layout = lay_out(
            {key: (label.width, _HEIGHT) for key, label in labels.items()}, arrows, _GAP_ALONG
        )
        if self._layout.extent[0] + 2 * _MARGIN > _PAGE:
            sizes = {key: (float(_HEIGHT), label.width) for key, label in labels.items()}
            down = lay_out(sizes, arrows, _GAP_ALONG_DOWN)
            # The page shrinks a picture that is too wide, and the text in it becomes too small. So choose the narrower
            # layout.
            if down.extent[1] < self._layout.extent[0]:
                self._down, self._layout = True, down

    def svg(self) -> str:
        """Return the whole picture."""
        width, height = (extent + 2 * _MARGIN for extent in self._turned(self._layout.extent))
        boxes = "".join(self._box(name) for name in self._layout.centers)
        lines = "".join(self._line(arrow) for arrow in self._layout.arrows)
        head = f"<title>The running graph</title><desc>{escape(self._words)}</desc>"
        return svg_page(width, height, head, _STYLE, lines + boxes)

    def _turned(self, point: Point) -> Point:
        return (point[1], point[0]) if self._down else point

    def _xy(self, point: Point) -> Point:
        x, y = self._turned(point)
        return x + _MARGIN, y + _MARGIN

    def _box(self, name: str) -> str:
        label = self._labels[name]
        x, y = self._xy(self._layout.centers[name])
        round_corners = _HEIGHT / 2 if label.shape == "node" else 3
        rect = (
            f'<rect x="{x - label.width / 2:.1f}" y="{y - _HEIGHT / 2:.1f}" width="{label.width:.1f}" '
            f'height="{_HEIGHT}" rx="{round_corners}"/>'
        )
        above = 9 if label.type else 0
        texts = f'<text x="{x:.1f}" y="{y - above:.1f}">{escape(label.name)}</text>'
        if label.type:
            texts += f'<text class="type" x="{x:.1f}" y="{y + 10:.1f}">{escape(label.small_print)}</text>'
        if rate := self._rates.get(name):
            edge = (x + label.width / 2 - 8, y - _HEIGHT / 2)
            texts += f'<text class="rate" x="{edge[0]:.1f}" y="{edge[1]:.1f}">{escape(rate)}</text>'
        return f'<g class="box {label.shape}">{rect}{texts}</g>'

    def _line(self, arrow: Arrow) -> str:
        """Return the SVG of an arrow: a curve along its route, and an arrowhead."""
        path = "M{:.1f},{:.1f}".format(*self._xy(arrow.points[0]))
        for (a1, b1), (a2, b2) in itertools.pairwise(arrow.points):
            middle = (a1 + a2) / 2
            corners = ((middle, b1), (middle, b2), (a2, b2))
            path += " C" + " ".join("{:.1f},{:.1f}".format(*self._xy(corner)) for corner in corners)
        flows = " flows" if {arrow.start, arrow.end} & self._rates.keys() else ""
        return f'<path class="line{flows}" d="{path}"/><path class="head" d="{self._head(arrow)}"/>'

    def _head(self, arrow: Arrow) -> str:
        (before, _), (along, beside) = arrow.points[-2:]
        back = -8 if along > before else 8
        corners = ((along, beside), (along + back, beside - 4.5), (along + back, beside + 4.5))
        return "M" + " L".join("{:.1f},{:.1f}".format(*self._xy(corner)) for corner in corners) + " z"


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
        centers: The center of each box.
        arrows: The arrows, in the same order as the input.
        extent: The size of the whole layout: first in the direction of the arrows, then across it.
    """

    centers: Mapping[str, Point]
    arrows: tuple[Arrow, ...]
    extent: Point


def lay_out(sizes: Mapping[str, Point], arrows: Sequence[tuple[str, str]], gap: float) -> GraphLayout:
    """Return the positions of boxes and arrows, with coordinates from 0.

    Args:
        sizes: The size of each box: first in the direction of the arrows, then across it.
        arrows: The two boxes that each arrow joins, in its direction. Arrows from a box to itself are left out.
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

    centers = {box: middle(*places[index]) for box, index in number.items()}
    ways = [
        [centers[a], *(middle(*point) for point in routed), centers[b]]
        for (a, b), routed in zip(drawn, routing, strict=True)
    ]
    extent = (
        max(centers[box][0] + sizes[box][0] / 2 for box in boxes),
        max(beside for way in (*ways, [*centers.values()]) for _, beside in way) + start,
    )
    return GraphLayout(centers, _with_ports(drawn, ways, sizes), extent)


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
            center = ways[index][0 if leaves else -1]
            share = (place + 1) / (len(there) + 1) - 0.5
            ports[index, leaves] = (
                center[0] + (width / 2 if after else -width / 2),
                center[1] + share * height * _PORTS,
            )
    return tuple(
        Arrow(a, b, (ports[index, True], *ways[index][1:-1], ports[index, False]))
        for index, (a, b) in enumerate(drawn)
    )
