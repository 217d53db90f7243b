"""Draws the running graph, once or live: nodes, and the topics, services and actions between them.

The picture is SVG, with a description in words for readers who cannot see it. JupyterLab's theme does not apply inside
the picture. So in a dark theme, the light picture is shown with inverted brightness.

Boxes stand in three columns, with topics, services and actions in the middle. A node is on the right if more arrows end
at it than begin at it, so most arrows go to the right. Every arrow joins two neighboring columns, so it passes no box.
The boxes of a column are sorted by the mean heights of their neighbors, so that fewer arrows cross. Each arrow begins
and ends at its own point on the edge of a box, so that two arrows in opposite directions can be told apart.
"""

from __future__ import annotations

import time
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from html import escape
from statistics import fmean
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
    from collections.abc import Iterable, Mapping, Sequence

    from rclpy.node import Node


Point = tuple[float, float]
"""A position in pixels, from the left and from the top."""
Arrow = tuple[str, str]
"""The keys of the two boxes that an arrow joins, in its direction."""

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
_GAP_ACROSS = 90
_GAP_BELOW = 24
_MARGIN = 12
_PORTS = 0.72
"""The fraction of a box's edge, from 0 to 1, that has room for the ends of arrows."""
_SWEEPS = 4
"""The number of times that the columns are sorted by the heights of their neighbors."""

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
        return _Drawing(labels, arrows, rates).svg(" ".join(self.sentences()))

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
        """The minimum width of the box, in pixels."""
        return max(len(self.name) * 1.1, len(self.small_print)) * _LETTER + 2 * _PADDING


def _node_key(node: str) -> str:
    return f"node {node}"


def _channel_key(channel: GraphChannel) -> str:
    return f"{channel.kind} {channel.name} {channel.type}"


class _Drawing:
    """Computes the places of boxes, and draws boxes and arrows as SVG.

    Args:
        labels: The boxes by their keys.
        arrows: The arrows. One that is given twice is drawn once.
        rates: The rates to show, by the key of the topic.
    """

    def __init__(
        self, labels: Mapping[str, _Label], arrows: Iterable[Arrow], rates: Mapping[str, str]
    ) -> None:
        self._labels = labels
        self._arrows = list(dict.fromkeys(arrows))
        self._rates = rates
        self._neighbors: defaultdict[str, list[str]] = defaultdict(list)
        for start, end in self._arrows:
            self._neighbors[start].append(end)
            self._neighbors[end].append(start)
        self._centers: dict[str, Point] = {}
        self._widths: dict[str, float] = {}
        self._width, self._height = self._place(self._columns())

    def _columns(self) -> list[list[str]]:
        """Return the boxes of each column, from top to bottom."""
        begin, end = (Counter(arrow[which] for arrow in self._arrows) for which in (0, 1))
        columns: list[list[str]] = [[], [], []]
        for key, label in self._labels.items():
            columns[1 if label.shape != "node" else 2 if end[key] > begin[key] else 0].append(key)
        for _ in range(_SWEEPS):
            for column in columns:
                rows = {key: row - len(boxes) / 2 for boxes in columns for row, key in enumerate(boxes)}
                means = {key: fmean(rows[one] for one in self._neighbors[key] or [key]) for key in column}
                column.sort(key=means.__getitem__)
        return [column for column in columns if column]

    def _place(self, columns: Sequence[Sequence[str]]) -> Point:
        """Give each box its place, and the width of its column. Return the width and the height of the picture."""
        row = _HEIGHT + _GAP_BELOW
        height = max(map(len, columns), default=1) * row - _GAP_BELOW + 2 * _MARGIN
        left = float(_MARGIN)
        for column in columns or [[]]:
            width = max((self._labels[key].width for key in column), default=0.0)
            top = (height - len(column) * row + row) / 2
            for number, key in enumerate(column):
                self._centers[key] = left + width / 2, top + number * row
                self._widths[key] = width
            left += width + _GAP_ACROSS
        return left - _GAP_ACROSS + _MARGIN, height

    def svg(self, words: str) -> str:
        """Return the whole picture, with its description in words."""
        boxes = "".join(map(self._box, self._centers))
        ports = self._ports()
        lines = "".join(
            self._line(arrow, ports[arrow[0], arrow], ports[arrow[1], arrow]) for arrow in self._arrows
        )
        head = f"<title>The running graph</title><desc>{escape(words)}</desc>"
        return svg_page(self._width, self._height, head, _STYLE, lines + boxes)

    def _box(self, key: str) -> str:
        label, width = self._labels[key], self._widths[key]
        x, y = self._centers[key]
        round_corners = _HEIGHT / 2 if label.shape == "node" else 3
        rect = (
            f'<rect x="{x - width / 2:.1f}" y="{y - _HEIGHT / 2:.1f}" width="{width:.1f}" '
            f'height="{_HEIGHT}" rx="{round_corners}"/>'
        )
        above = 9 if label.type else 0
        texts = f'<text x="{x:.1f}" y="{y - above:.1f}">{escape(label.name)}</text>'
        if label.type:
            texts += f'<text class="type" x="{x:.1f}" y="{y + 10:.1f}">{escape(label.small_print)}</text>'
        if rate := self._rates.get(key):
            edge = (x + width / 2 - 8, y - _HEIGHT / 2)
            texts += f'<text class="rate" x="{edge[0]:.1f}" y="{edge[1]:.1f}">{escape(rate)}</text>'
        return f'<g class="box {label.shape}">{rect}{texts}</g>'

    def _line(self, arrow: Arrow, start: Point, end: Point) -> str:
        """Return the SVG of an arrow: a curve from point to point, and an arrowhead."""
        (x1, y1), (x2, y2) = start, end
        middle, back = (x1 + x2) / 2, -8 if x2 > x1 else 8
        path = f"M{x1:.1f},{y1:.1f} C{middle:.1f},{y1:.1f} {middle:.1f},{y2:.1f} {x2:.1f},{y2:.1f}"
        head = f"M{x2:.1f},{y2:.1f} l{back},-4.5 v9 z"
        flows = " flows" if self._rates.keys() & set(arrow) else ""
        return f'<path class="line{flows}" d="{path}"/><path class="head" d="{head}"/>'

    def _ports(self) -> dict[tuple[str, Arrow], Point]:
        """Return the point on the edge of a box at which an arrow begins or ends, by the box and the arrow."""
        sides: defaultdict[tuple[str, int], list[tuple[float, Arrow]]] = defaultdict(list)
        for arrow in self._arrows:
            for box, other in (arrow, arrow[::-1]):
                x, y = self._centers[other]
                sides[box, 1 if x > self._centers[box][0] else -1].append((y, arrow))
        ports = {}
        for (box, side), ends in sides.items():
            x, y = self._centers[box]
            for place, (_, arrow) in enumerate(sorted(ends), 1):
                share = place / (len(ends) + 1) - 0.5
                ports[box, arrow] = x + side * self._widths[box] / 2, y + share * _HEIGHT * _PORTS
        return ports
