"""A picture of the running graph: nodes, and the topics, services and actions between them.

It is SVG, with the same in words beside it for those who cannot see it. It has a ground of its own, so that it
is readable on a dark page as well, and is an ``img`` with data in it: JupyterLab takes SVG elements out of what
it does not trust yet, and leaves their letters.
"""

from __future__ import annotations

import base64
import itertools
from dataclasses import dataclass
from html import escape

from autograder.notebook.graph_layout import Layout, Line, is_place_holder, lay_out, place_beside
from autograder.notebook.ros_graph import Channel, Kind, RosGraph, read_graph

# Pixels.
_LETTER = 7.3
_PADDING = 14
_HEIGHT = 42
_GAP_ALONG = 52
_GAP_ALONG_DOWN = 34
_MARGIN = 12
_PAGE = 860
"""What a notebook's column takes; a wider picture is drawn from top to bottom."""

_STYLE = """
.ground { fill: #fff; }
text { font: 13px/1 monospace; fill: #212121; text-anchor: middle; dominant-baseline: central; }
text.type { font-size: 10.5px; fill: #555; }
.box rect { fill: #fff; stroke: #212121; }
.node rect { fill: #e8eef7; stroke-width: 2; }
.service rect { stroke-dasharray: 5 3; }
.action rect { stroke-dasharray: 1.5 2.5; }
path.line { fill: none; stroke: #555; stroke-width: 1.5; }
path.head { fill: #555; }
"""


def draw_graph() -> GraphPicture:
    """A picture of what runs now, to be shown at the end of a cell.

    It shows every node that this kernel's ROS domain has, also those of other programs. What every node has
    (its log, its parameters) is left out.
    """
    return GraphPicture(read_graph())


@dataclass(frozen=True, repr=False)
class GraphPicture:
    """A graph that JupyterLab shows as a picture and that reads as text anywhere else."""

    graph: RosGraph

    def __repr__(self) -> str:
        """The graph in words."""
        return "\n".join(self.graph.sentences())

    def _repr_html_(self) -> str:
        sentences = self.graph.sentences()
        data = base64.b64encode(self.svg().encode()).decode()
        words = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
        return (
            f'<img alt="The running graph. {escape(" ".join(sentences))}" src="data:image/svg+xml;base64,{data}">'
            f"<details><summary>The graph in words</summary><ul>{words}</ul></details>"
        )

    def svg(self) -> str:
        """The picture alone."""
        labels = {_node_key(node): _Label("node", node) for node in self.graph.nodes}
        labels |= {_channel_key(c): _Label(c.kind, c.name, c.type) for c in self.graph.channels}
        layout = lay_out(list(labels), _arrows(self.graph))
        return _Drawing(layout, labels, " ".join(self.graph.sentences())).svg()


@dataclass(frozen=True)
class _Label:
    shape: str
    name: str
    type: str = ""

    @property
    def small_print(self) -> str:
        """The line below the name."""
        return self.type if self.shape in (Kind.TOPIC, "node") else f"{self.shape}: {self.type}"

    @property
    def width(self) -> float:
        """Of the box, in pixels."""
        return max(len(self.name) * 1.1, len(self.small_print) * 0.9) * _LETTER + 2 * _PADDING


def _node_key(node: str) -> str:
    return f"node {node}"


def _channel_key(channel: Channel) -> str:
    return f"{channel.kind} {channel.name} {channel.type}"


def _arrows(graph: RosGraph) -> list[tuple[str, str]]:
    """From who publishes or asks to the channel, and from there to who subscribes or serves."""
    return [
        (_node_key(end.node), _channel_key(end.channel))
        if end.gives
        else (_channel_key(end.channel), _node_key(end.node))
        for end in graph.ends
    ]


Point = tuple[float, float]


class _Drawing:
    """Turns columns into coordinates, and coordinates into SVG.

    *Along* is the way that the arrows take, *beside* is across it. Along runs to the right, or down where the
    picture would be too wide.
    """

    def __init__(self, layout: Layout, labels: dict[str, _Label], words: str) -> None:
        self._layout = layout
        self._labels = labels
        self._words = words
        self._down = False
        self._down = self._length() > _PAGE
        self._centres = self._place()

    def _box_size(self, name: str) -> Point:
        """Along and beside."""
        if is_place_holder(name):
            return (0.0, _HEIGHT / 2)
        width = self._labels[name].width
        return (_HEIGHT, width) if self._down else (width, _HEIGHT)

    def _thickness(self) -> list[float]:
        """How much each column takes along."""
        return [max(self._box_size(name)[0] for name in column) for column in self._layout.columns]

    def _gap(self) -> float:
        return _GAP_ALONG_DOWN if self._down else _GAP_ALONG

    def _length(self) -> float:
        """Of the picture, along."""
        gaps = self._gap() * max(len(self._layout.columns) - 1, 0)
        return sum(self._thickness()) + gaps + 2 * _MARGIN

    def _place(self) -> dict[str, Point]:
        beside = place_beside(self._layout, {name: self._box_size(name)[1] for name in self._names()})
        centres = {}
        along = float(_MARGIN)
        for column, thickness in zip(self._layout.columns, self._thickness(), strict=True):
            for name in column:
                centres[name] = (along + thickness / 2, beside[name] + _MARGIN)
            along += thickness + self._gap()
        return centres

    def _names(self) -> list[str]:
        return [name for column in self._layout.columns for name in column]

    def _extent(self) -> Point:
        """Of the picture, along and beside."""
        edges = [self._centres[name][1] + self._box_size(name)[1] / 2 for name in self._names()]
        return self._length(), max(edges, default=0.0) + _MARGIN

    def _xy(self, point: Point) -> Point:
        return (point[1], point[0]) if self._down else point

    def svg(self) -> str:
        """The whole picture."""
        width, height = self._xy(self._extent())
        boxes = "".join(self._box(name) for name in self._centres if not is_place_holder(name))
        lines = "".join(self._line(line) for line in self._layout.lines)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{width:.0f}" height="{height:.0f}" '
            f'viewBox="0 0 {width:.0f} {height:.0f}">'
            f"<title>The running graph</title><desc>{escape(self._words)}</desc><style>{_STYLE}</style>"
            f'<rect class="ground" width="100%" height="100%" rx="6"/>{lines}{boxes}</svg>'
        )

    def _box(self, name: str) -> str:
        label = self._labels[name]
        x, y = self._xy(self._centres[name])
        round_corners = _HEIGHT / 2 if label.shape == "node" else 3
        rect = (
            f'<rect x="{x - label.width / 2:.1f}" y="{y - _HEIGHT / 2:.1f}" width="{label.width:.1f}" '
            f'height="{_HEIGHT}" rx="{round_corners}"/>'
        )
        above = 8 if label.type else 0
        texts = f'<text x="{x:.1f}" y="{y - above:.1f}">{escape(label.name)}</text>'
        if label.type:
            texts += f'<text class="type" x="{x:.1f}" y="{y + 10:.1f}">{escape(label.small_print)}</text>'
        return f'<g class="box {label.shape}">{rect}{texts}</g>'

    def _line(self, line: Line) -> str:
        """A curve from box to box, along the places that were kept free, with a head where it points to."""
        points = self._points(line)
        path = "M{:.1f},{:.1f}".format(*self._xy(points[0]))
        for (a1, b1), (a2, b2) in itertools.pairwise(points):
            middle = (a1 + a2) / 2
            corners = ((middle, b1), (middle, b2), (a2, b2))
            path += " C" + " ".join("{:.1f},{:.1f}".format(*self._xy(corner)) for corner in corners)
        return f'<path class="line" d="{path}"/><path class="head" d="{self._head(points, line.turned)}"/>'

    def _head(self, points: list[Point], turned: bool) -> str:
        (along, beside), back = (points[0], 8) if turned else (points[-1], -8)
        corners = ((along, beside), (along + back, beside - 4.5), (along + back, beside + 4.5))
        return "M" + " L".join("{:.1f},{:.1f}".format(*self._xy(corner)) for corner in corners) + " z"

    def _points(self, line: Line) -> list[Point]:
        """Where the curve leaves and enters boxes."""
        points = []
        for place, name in enumerate(line.way):
            along, beside = self._centres[name]
            half = self._box_size(name)[0] / 2
            if place > 0:
                points.append((along - half, beside))
            if place < len(line.way) - 1:
                points.append((along + half, beside))
        return points
