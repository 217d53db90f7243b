"""`ros2 topic hz`, `bw` and `delay`, which measure the messages on a topic."""

from __future__ import annotations

import argparse
import math
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import add_graph_arguments, graph_node
from course_runtime.ros2_command.topic_echo import message_filter
from course_runtime.ros2_command.topic_type import message_class

if TYPE_CHECKING:
    from collections.abc import Sequence

_WINDOW = 10000  # messages
_NANOSECONDS = 1_000_000_000


@dataclass
class Intervals:
    """The intervals between the last messages. All times are in nanoseconds."""

    window: int = _WINDOW
    last: int | None = None
    shown_at: int | None = None
    intervals: deque[int] = field(default_factory=deque)

    def add(self, now: int) -> None:
        """Record a message. If the clock has gone back, begin again."""
        if self.last is None or now < self.last:
            self.intervals.clear()
            self.shown_at = None
        else:
            self.intervals.append(now - self.last)
        self.last = now
        while len(self.intervals) > self.window:
            self.intervals.popleft()

    def report(self) -> str | None:
        """Return the report, which is due once a second of the topic's own time; None before that."""
        if not self.intervals or self.last is None:
            return None
        if self.shown_at is None:
            self.shown_at = self.last
            return None
        if self.last < self.shown_at + _NANOSECONDS:
            return None
        self.shown_at = self.last
        mean = sum(self.intervals) / len(self.intervals)
        return f"average rate: {_NANOSECONDS / mean if mean else 0:.3f}\n{_summary(self.intervals)}"


def _positive_int(text: str) -> int:
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError("value must be a positive integer")
    return int(text)


@dataclass
class Sizes:
    """The sizes of the last messages in bytes, each with its time in nanoseconds."""

    window: int
    found: deque[tuple[int, int]] = field(default_factory=deque)

    def add(self, now: int, size: int) -> None:
        """Record a message."""
        self.found.append((now, size))
        while len(self.found) > self.window:
            self.found.popleft()

    def report(self, now: int) -> str | None:
        """Return a report on the messages so far; None if there are fewer than two."""
        if len(self.found) < 2 or now <= self.found[0][0]:
            return None
        sizes = [size for _, size in self.found]
        per_second = sum(sizes) * _NANOSECONDS / (now - self.found[0][0])
        unit, factor, digits = next(one for one in _UNITS if per_second < one[1] * 1000 or one is _UNITS[-1])
        rate, mean, least, most = (
            f"{value / factor:.{digits}f} {unit}"
            for value in (per_second, sum(sizes) / len(sizes), min(sizes), max(sizes))
        )
        return f"{rate}/s from {len(sizes)} messages\n\tMessage size mean: {mean} min: {least} max: {most}"


_UNITS = (("B", 1, 0), ("KB", 1000, 2), ("MB", 1_000_000, 2))
"""The units of ros2cli, each with its number of bytes and the number of decimals to show."""


def _summary(nanoseconds: Sequence[int]) -> str:
    """Return the second line of ``hz`` and ``delay``: the spread of times."""
    count = len(nanoseconds)
    mean = sum(nanoseconds) / count
    deviation = math.sqrt(sum((x - mean) ** 2 for x in nanoseconds) / count)
    return (
        f"\tmin: {min(nanoseconds) / _NANOSECONDS:.3f}s max: {max(nanoseconds) / _NANOSECONDS:.3f}s "
        f"std dev: {deviation / _NANOSECONDS:.5f}s window: {count}"
    )


def _topic_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')")
    parser.add_argument(
        "--window",
        "-w",
        dest="window_size",
        type=_positive_int,
        default=_WINDOW,
        metavar="WINDOW",
        help=f"window size, in # of messages, for calculating rate (default: {_WINDOW})",
    )


def _arguments(parser: argparse.ArgumentParser) -> None:
    _topic_arguments(parser)
    parser.add_argument(
        "--filter",
        dest="filter_expr",
        metavar="EXPR",
        help="only measure messages matching the specified Python expression",
    )
    parser.add_argument(
        "--wall-time",
        dest="use_wtime",
        action="store_true",
        help="calculates rate using wall time which can be helpful when clock is not "
        "published during simulation",
    )
    add_graph_arguments(parser)


def _hz(args: argparse.Namespace) -> Outcome:
    import rclpy
    from rclpy.clock import Clock
    from rclpy.clock_type import ClockType
    from rclpy.qos import qos_profile_sensor_data

    passes = message_filter(args.filter_expr)
    intervals = Intervals(args.window_size)
    with graph_node(args) as node:
        message_type = message_class(node, args.topic_name, wait=True)
        clock = Clock(clock_type=ClockType.SYSTEM_TIME) if args.use_wtime else node.get_clock()

        def received(message: Any) -> None:
            # A simulated clock shows 0 until the first /clock message.
            if passes(message) and (now := clock.now().nanoseconds):
                intervals.add(now)

        node.create_subscription(message_type, args.topic_name, received, qos_profile_sensor_data)
        while node.context.ok():
            rclpy.spin_once(node)
            if text := intervals.report():
                print(text)
    return None


def _plain_arguments(parser: argparse.ArgumentParser) -> None:
    _topic_arguments(parser)
    add_graph_arguments(parser)


def _bw(args: argparse.Namespace) -> Outcome:
    import rclpy
    from rclpy.qos import qos_profile_sensor_data

    sizes = Sizes(args.window_size)
    with graph_node(args) as node:
        message_type = message_class(node, args.topic_name, wait=True)
        clock = node.get_clock()

        def report() -> None:
            if text := sizes.report(clock.now().nanoseconds):
                print(text)

        def received(serialized: Any) -> None:
            sizes.add(clock.now().nanoseconds, len(serialized))

        node.create_subscription(message_type, args.topic_name, received, qos_profile_sensor_data, raw=True)
        print(f"Subscribed to [{args.topic_name}]")
        node.create_timer(1.0, report)
        while node.context.ok():
            rclpy.spin_once(node)
    return None


def _delay(args: argparse.Namespace) -> Outcome:
    import rclpy
    from rclpy.qos import qos_profile_sensor_data
    from rclpy.time import Time

    delays: deque[int] = deque(maxlen=args.window_size)
    with graph_node(args) as node:
        message_type: Any = message_class(node, args.topic_name, wait=True)
        if "header" not in message_type.get_fields_and_field_types():
            return (
                f"The messages on {args.topic_name} have no header, and so no time of sending: "
                "`ros2 topic delay` measures only messages with one, such as sensor_msgs/msg/Range"
            )
        clock = node.get_clock()

        def received(message: Any) -> None:
            if now := clock.now().nanoseconds:
                delays.append(now - Time.from_msg(message.header.stamp).nanoseconds)

        def report() -> None:
            if delays:
                mean = sum(delays) / len(delays)
                print(f"average delay: {mean / _NANOSECONDS:.3f}\n{_summary(delays)}")

        node.create_subscription(message_type, args.topic_name, received, qos_profile_sensor_data)
        node.create_timer(1.0, report)
        while node.context.ok():
            rclpy.spin_once(node)
    return None


VERBS = {
    "bw": Verb(_plain_arguments, _bw),
    "delay": Verb(_plain_arguments, _delay),
    "hz": Verb(_arguments, _hz),
}
