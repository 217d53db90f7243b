"""Plots a number in the messages of a topic over time."""

from __future__ import annotations

import math
import time
import zlib
from collections import deque
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

import re2

from autograder.cards.timeline_layout import round_step
from autograder.notebook.observing.live_picture import LivePicture, as_image, svg_page
from autograder.notebook.observing.ros_graph import UNDEMANDING_QOS, message_class

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rclpy.node import Node
    from rclpy.subscription import Subscription


PERIOD = 0.5
"""Seconds between two pictures while messages arrive."""
WINDOW = 30.0
"""The length of the time axis, in seconds."""
_LARGEST = 1e300
"""The maximum absolute value that is drawn. So infinity and NaN are not drawn: a laser scan, for example, has ``inf``
in directions without an obstacle.
"""
_MOST = 3_000
"""The maximum number of points in a plot; older points are dropped."""
_WIDTH, _HEIGHT, _LEFT, _FOOT, _HEAD = 720, 220, 70, 24, 26

_STYLE = """
.ground { fill: #fff; }
text { font: 11px/1 monospace; fill: #444; }
text.name { font-size: 12px; fill: #212121; }
line { stroke: #ddd; }
polyline { fill: none; stroke: #0b5cad; stroke-width: 1.5; }
circle { fill: #0b5cad; }
"""


def plot(topic: str, field: str, minutes: float = 10.0) -> LivePicture:
    """Plot one number of each message on a topic over time. The plot is shown below this cell and kept up to date.

    Updating ends as for ``watch_graph``, and the last picture stays.

    Args:
        topic: The name of the topic, such as ``"/odom"``.
        field: The path of the number in a message, such as ``"data"``, ``"pose.pose.position.x"`` or ``"ranges[0]"``.
        minutes: The number of minutes for which the plot is kept up to date.

    Raises:
        ValueError: ``minutes`` is not a positive number, or ``field`` is not a valid path.
    """
    if not _FIELD.fullmatch(field):
        raise ValueError(
            f'field is the path of a number in a message, such as "pose.pose.position.x", not {field!r}'
        )
    shown = LivePicture(_Plots(topic if topic.startswith("/") else f"/{topic}", field), minutes)
    shown.start()
    return shown


_FIELD = re2.compile(r"\w+(\[\d+\])?(\.\w+(\[\d+\])?)*")
_STEP = re2.compile(r"(\w+)(?:\[(\d+)\])?")


def number_in(message: Any, field: str) -> float:
    """Return the number in a field of a message.

    Raises:
        LookupError: The field does not exist or is not a number. The message lists the fields that exist.
    """
    value, way = message, list[str]()
    for name, index in _STEP.findall(field):
        fields = _fields(value)
        if name not in fields:
            there = ", ".join(fields) or "no fields"
            raise LookupError(f"{'.'.join(way) or 'the message'} has no field {name}: it has {there}")
        value, way = getattr(value, name), [*way, name]
        if index:
            if not hasattr(value, "__len__"):
                raise LookupError(
                    f"{'.'.join(way)} is a {type(value).__name__}, not a list: leave out [{index}]"
                )
            if not 0 <= int(index) < len(value):
                raise LookupError(f"{'.'.join(way)} has {len(value)} items: there is no [{index}]")
            value = value[int(index)]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        try:
            # float() is for the number types of NumPy; it would also accept a text such as "3".
            if isinstance(value, (str, bytes)):
                raise TypeError
            return float(value)
        except TypeError:
            fields = _fields(value)
            there = f": name one of its fields ({', '.join(fields)})" if fields else ""
            raise LookupError(f"{field} is a {type(value).__name__}, not a number{there}") from None
    return float(value)


def _fields(value: Any) -> Mapping[str, str]:
    """Return the fields of a message with their types; none if the value is not a message."""
    found: Mapping[str, str] = getattr(value, "get_fields_and_field_types", dict)()
    return found


@dataclass(frozen=True, repr=False)
class PlotPicture:
    """One picture of a plot.

    Attributes:
        title: The name of the plotted field.
        points: Pairs of time and value, sorted by time. The time is in seconds, 0 for now and negative for the past.
        note: The reason why no curve can be drawn; empty if one is drawn.
    """

    title: str
    points: Sequence[tuple[float, float]]
    note: str = ""

    def __repr__(self) -> str:
        """Return the plot in words."""
        if words := self._words():
            return f"{self.title}: {words}"
        values = [value for _, value in self._drawn()]
        return (
            f"{self.title}: {len(values)} values in {-self.points[0][0]:.0f} s, from {min(values):.6g} to "
            f"{max(values):.6g}, the last {values[-1]:.6g}"
        )

    def _repr_html_(self) -> str:
        return as_image(self.svg(), repr(self))

    def svg(self) -> str:
        """Return the picture as SVG."""
        words = self._words()
        curve = f'<text x="{_LEFT}" y="{_HEIGHT / 2}">{escape(words)}</text>' if words else self._curve()
        name = f'<text class="name" x="{_LEFT}" y="16">{escape(self.title)}</text>'
        head = f"<title>{escape(repr(self))}</title>"
        return svg_page(_WIDTH, _HEIGHT, head, _STYLE, name + curve)

    def _drawn(self) -> Sequence[tuple[float, float]]:
        return [(t, value) for t, value in self.points if abs(value) <= _LARGEST]

    def _words(self) -> str:
        """Return the text to show instead of a curve; empty if there is a curve."""
        if not self.points:
            return self.note or "nothing has arrived yet"
        return self.note or (
            "" if self._drawn() else f"the last value is {self.points[-1][1]}: nothing to draw"
        )

    def _curve(self) -> str:
        points = self._drawn()
        low, high = min(value for _, value in points), max(value for _, value in points)
        # A constant curve has no height, but its axis needs a step, too.
        step = round_step(max(high - low, abs(high) * 1e-6, 1e-9) / 4)
        low, high = math.floor(low / step) * step, math.ceil(high / step + 1e-9) * step
        start = -WINDOW

        def x(t: float) -> float:
            return _LEFT + (t - start) / WINDOW * (_WIDTH - _LEFT - 14)

        def y(value: float) -> float:
            return _HEIGHT - _FOOT - (value - low) / (high - low) * (_HEIGHT - _FOOT - _HEAD)

        drawn = []
        for number in range(round((high - low) / step) + 1):
            value = low + number * step
            drawn.append(
                f'<line x1="{_LEFT}" x2="{_WIDTH}" y1="{y(value):.1f}" y2="{y(value):.1f}"/>'
                f'<text x="{_LEFT - 6}" y="{y(value) + 4:.1f}" text-anchor="end">{value:.6g}</text>'
            )
        for seconds in range(-int(WINDOW), 1, 10):
            words = "now" if seconds == 0 else f"{seconds} s"
            anchor = "end" if seconds == 0 else "middle"
            drawn.append(
                f'<text x="{x(seconds):.1f}" y="{_HEIGHT - 6}" text-anchor="{anchor}">{words}</text>'
            )
        path = " ".join(f"{x(t):.1f},{y(value):.1f}" for t, value in points)
        last = points[-1]
        drawn.append(
            f'<polyline points="{path}"/><circle cx="{x(last[0]):.1f}" cy="{y(last[1]):.1f}" r="3"/>'
        )
        return "".join(drawn)


class _Plots:
    def __init__(self, topic: str, field: str) -> None:
        # Each plot has a different name, so that it does not replace the plot of another field.
        self.name = f"_plot_{zlib.crc32(f'{topic} {field}'.encode()):x}"
        self.period = PERIOD
        self._topic = topic
        self._field = field
        self._points: deque[tuple[float, float]] = deque(maxlen=_MOST)
        self._subscription: Subscription | None = None

    def first(self) -> PlotPicture:
        return self._picture()

    def next(self, node: Node) -> PlotPicture | None:
        note = ""
        try:
            came = self._take(node)
        except LookupError as error:
            came, note = True, str(error)
        return self._picture(note) if came else None

    def last(self) -> None:
        return None

    def _picture(self, note: str = "") -> PlotPicture:
        now = time.time()
        while self._points and self._points[0][0] < now - WINDOW:
            self._points.popleft()
        points = tuple((t - now, value) for t, value in self._points)
        return PlotPicture(f"{self._topic} {self._field}", points, note)

    def _take(self, node: Node) -> bool:
        """Take the messages that have arrived. Return True if there was at least one."""
        if self._subscription is None:
            types = dict(node.get_topic_names_and_types()).get(self._topic)
            if not types:
                return False
            self._subscription = node.create_subscription(
                message_class(types[0]), self._topic, lambda _: None, UNDEMANDING_QOS
            )
        came = False
        handle = self._subscription.handle
        with handle:
            while (taken := handle.take_message(self._subscription.msg_type, False)) is not None:
                message, info = taken
                self._points.append((info["source_timestamp"] / 1e9, number_in(message, self._field)))
                came = True
        return came
