"""`ros2 topic pub`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import add_graph_arguments, graph_node
from course_runtime.ros2_command.interface_types import load_type
from course_runtime.ros2_command.messages import fill, parse_values
from course_runtime.ros2_command.qos import add_qos_arguments, given_profile
from course_runtime.ros2_command.topic_echo import positive_float, unsigned_int
from course_runtime.ros2_command.values_argument import add_values_argument, given_values

if TYPE_CHECKING:
    import argparse

    from rclpy.node import Node

# Seconds.
_POLL = 0.01
_TELL_EVERY = 1.0
_ACKNOWLEDGED = 5.0


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("topic_name", help="Name of the ROS topic to publish to (e.g. '/chatter')")
    parser.add_argument("message_type", help="Type of the ROS message (e.g. 'std_msgs/String')")
    add_values_argument(
        parser,
        "values",
        "Values to fill the message with in YAML format (e.g. 'data: Hello World'), otherwise the message "
        "will be published with default values",
        "Read values from standard input",
    )
    parser.add_argument(
        "-r",
        "--rate",
        metavar="N",
        type=positive_float,
        default=1.0,
        help="Publishing rate in Hz (default: 1)",
    )
    parser.add_argument(
        "-p",
        "--print",
        metavar="N",
        type=int,
        default=1,
        help="Only print every N-th published message (default: 1)",
    )
    group = parser.add_mutually_exclusive_group()
    group.add_argument("-1", "--once", action="store_true", help="Publish one message and exit")
    group.add_argument(
        "-t", "--times", type=unsigned_int, default=0, help="Publish this number of times and then exit"
    )
    parser.add_argument(
        "-w",
        "--wait-matching-subscriptions",
        type=unsigned_int,
        help="Wait until finding the specified number of matching subscriptions. Defaults to 1 when using "
        '"-1"/"--once"/"--times", otherwise defaults to 0.',
    )
    parser.add_argument(
        "--max-wait-time-secs",
        type=positive_float,
        help="This sets the maximum wait time in seconds if --wait-until-matching-subscriptions is set. By "
        "default, this flag is not set meaning the subscriber will wait endlessly.",
    )
    parser.add_argument(
        "--keep-alive",
        metavar="N",
        type=positive_float,
        default=0.1,
        help="Keep publishing node alive for N seconds after the last msg (default: 0.1)",
    )
    parser.add_argument("-n", "--node-name", help="Name of the created publishing node")
    add_qos_arguments(parser, "publish", "default")
    add_graph_arguments(parser)


def _wait_for_subscriptions(publisher: Any, wanted: int, longest: float | None) -> str | None:
    """Wait until enough subscriptions match. Return an error if they do not in time."""
    start = time.monotonic()
    told = -_TELL_EVERY
    while publisher.get_subscription_count() < wanted:
        waited = time.monotonic() - start
        if waited - told >= _TELL_EVERY:
            print(f"Waiting for at least {wanted} matching subscription(s)...")
            told = waited
        if longest is not None and waited >= longest:
            return (
                f"Timed out waiting for subscribers: Expected {wanted} subcribers but only got "
                f"{publisher.get_subscription_count()} subscribers"
            )
        time.sleep(_POLL)
    return None


def _publish(
    node: Node, publisher: Any, message: Any, values: Any, times: int, args: argparse.Namespace
) -> None:
    import rclpy
    from rclpy.duration import Duration

    stamp_setters = fill(message, values)
    print("publisher: beginning loop")
    count = 0

    def publish() -> None:
        nonlocal count
        now = node.get_clock().now().to_msg()
        for set_stamp in stamp_setters:
            set_stamp(now)
        count += 1
        if args.print and count % args.print == 0:
            print(f"publishing #{count}: {message!r}\n")
        publisher.publish(message)

    publish()
    if times != 1:
        node.create_timer(1 / args.rate, publish)
        while times == 0 or count < times:
            rclpy.spin_once(node)
    # The last message must reach the subscribers before this node ends. Reliable subscribers confirm it.
    publisher.wait_for_all_acked(Duration(seconds=_ACKNOWLEDGED))
    time.sleep(args.keep_alive)


def _pub(args: argparse.Namespace) -> Outcome:
    try:
        message = load_type(args.message_type, "msg")()
    except ValueError:
        return "The passed message type is invalid"
    values = parse_values(given_values(args, "values"))
    times = 1 if args.once else args.times
    wanted = args.wait_matching_subscriptions
    if wanted is None:
        wanted = int(times != 0)
    if wanted == 0 and args.max_wait_time_secs is not None:
        return (
            "--max-wait-time-secs option is only effective with "
            "--wait-matching-subscriptions, --once or --times"
        )
    try:
        fill(type(message)(), values)
    except Exception as error:
        return f"Failed to populate field: {error}"
    with graph_node(args, name=args.node_name) as node:
        publisher = node.create_publisher(type(message), args.topic_name, given_profile(args))
        if trouble := _wait_for_subscriptions(publisher, wanted, args.max_wait_time_secs):
            return trouble
        _publish(node, publisher, message, values, times, args)
    return None


VERBS = {"pub": Verb(_arguments, _pub)}
