"""`ros2 topic hz`."""

from __future__ import annotations

import argparse
import math
from collections import deque
from dataclasses import dataclass, field
from typing import Any

from environment.ros2_command.commands import Outcome, Verb
from environment.ros2_command.graph_node import add_graph_arguments, graph_node
from environment.ros2_command.topic_echo import message_filter
from environment.ros2_command.topic_type import message_class

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
        """Note a message. Begin anew when the clock has gone back."""
        if self.last is None or now < self.last:
            self.intervals.clear()
            self.shown_at = None
        else:
            self.intervals.append(now - self.last)
        self.last = now
        while len(self.intervals) > self.window:
            self.intervals.popleft()

    def report(self) -> str | None:
        """Return the text that is due once a second of the topic's own time, None before."""
        if not self.intervals or self.last is None:
            return None
        if self.shown_at is None:
            self.shown_at = self.last
            return None
        if self.last < self.shown_at + _NANOSECONDS:
            return None
        self.shown_at = self.last
        count = len(self.intervals)
        mean = sum(self.intervals) / count
        deviation = math.sqrt(sum((x - mean) ** 2 for x in self.intervals) / count)
        return (
            f"average rate: {_NANOSECONDS / mean if mean else 0:.3f}\n"
            f"\tmin: {min(self.intervals) / _NANOSECONDS:.3f}s "
            f"max: {max(self.intervals) / _NANOSECONDS:.3f}s "
            f"std dev: {deviation / _NANOSECONDS:.5f}s window: {count}"
        )


def _positive_int(text: str) -> int:
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError("value must be a positive integer")
    return int(text)


def _arguments(parser: argparse.ArgumentParser) -> None:
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
            # A clock that shows 0 waits for the first /clock message.
            if passes(message) and (now := clock.now().nanoseconds):
                intervals.add(now)

        node.create_subscription(message_type, args.topic_name, received, qos_profile_sensor_data)
        while node.context.ok():
            rclpy.spin_once(node)
            if text := intervals.report():
                print(text)
    return None


VERBS = {"hz": Verb(_arguments, _hz)}
