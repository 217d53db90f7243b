"""`ros2 topic echo`."""

from __future__ import annotations

import argparse
import functools
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import add_graph_arguments, graph_node
from course_runtime.ros2_command.interface_types import load_type
from course_runtime.ros2_command.messages import Shortening, to_csv, to_yaml
from course_runtime.ros2_command.qos import add_qos_arguments, matching_profile
from course_runtime.ros2_command.topic_type import message_class

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.task import Future

_TRUNCATE_LENGTH = 128


def positive_float(text: str) -> float:
    """Return a text as a number that is greater than 0."""
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError("Expects a floating point number") from None
    if value <= 0:
        raise argparse.ArgumentTypeError("Value must be positive")
    return value


def unsigned_int(text: str) -> int:
    """Return a text as a whole number of at least 0."""
    if not text.isdecimal():
        raise argparse.ArgumentTypeError("value must be non-negative integer")
    return int(text)


def message_filter(expression: str | None) -> Callable[[Any], Any]:
    """Return a function that evaluates a Python expression about the message `m`; for None, all messages pass."""
    if expression is None:
        return lambda _: True
    code = compile(expression, "--filter", "eval")
    # The user typed the expression on the command line, as in ros2cli.
    return lambda message: eval(code, {"m": message})


def _arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')")
    parser.add_argument(
        "message_type", nargs="?", help="Type of the ROS message (e.g. 'std_msgs/msg/String')"
    )
    add_qos_arguments(parser, "subscribe", "sensor_data")
    parser.add_argument("--csv", action="store_true", help="Output all recursive fields separated by commas")
    parser.add_argument(
        "--field",
        help="Echo a selected field of a message. Use '.' to select sub-fields, as in pose.pose.position",
    )
    parser.add_argument(
        "--full-length",
        "-f",
        action="store_true",
        help="Output all elements for arrays, bytes, and string with a length > '--truncate-length'",
    )
    parser.add_argument(
        "--truncate-length",
        "-l",
        type=unsigned_int,
        default=_TRUNCATE_LENGTH,
        help=f"The length to truncate arrays, bytes, and string to (default: {_TRUNCATE_LENGTH})",
    )
    parser.add_argument("--no-arr", action="store_true", help="Don't print array fields of messages")
    parser.add_argument("--no-str", action="store_true", help="Don't print string fields of messages")
    parser.add_argument("--flow-style", action="store_true", help="Print collections in the flow style")
    parser.add_argument("--no-lost-messages", action="store_true", help="Don't report when a message is lost")
    parser.add_argument("--raw", action="store_true", help="Echo the raw binary representation")
    parser.add_argument(
        "--filter",
        dest="filter_expr",
        help="Python expression to filter messages that are printed. Expression can use Python builtins as "
        "well as m (the message).",
    )
    parser.add_argument("--once", action="store_true", help="Print the first message received and then exit.")
    parser.add_argument(
        "--timeout", metavar="N", type=positive_float, help="Set a timeout in seconds for waiting"
    )
    parser.add_argument(
        "--include-message-info", "-i", action="store_true", help="Shows the associated message info."
    )


def _field_of(message: Any, path: str | None) -> Any:
    try:
        return functools.reduce(getattr, filter(None, (path or "").split(".")), message)
    except AttributeError as error:
        raise RuntimeError(f"Invalid field '{path}': {error}") from error


def _text(shown: Any, info: dict[str, Any], args: argparse.Namespace) -> str:
    """Return the text to print for one message, or for the chosen field of it."""
    shorten = Shortening(None if args.full_length else args.truncate_length, args.no_arr, args.no_str)
    details = args.include_message_info
    if not hasattr(shown, "get_fields_and_field_types"):
        head = f"---Got new message, message info:---\n{info}\n---Message data:---\n" if details else ""
        return f"{head}{shown}\n---"
    if args.csv:
        head = f"{','.join(map(str, info.values()))}," if details else ""
        return head + to_csv(shown, shorten)
    import yaml

    head = f"{yaml.dump(info)}---\n" if details else ""
    return f"{head}{to_yaml(shown, shorten, flow_style=args.flow_style)}---"


def _report_lost(status: Any) -> None:
    print(
        f"A message was lost!!!\n\ttotal count change:{status.total_count_change}\n"
        f"\ttotal count: {status.total_count}\n---"
    )


def _listen(node: Node, message_type: Any, args: argparse.Namespace, done: Future) -> None:
    from rclpy.event_handler import SubscriptionEventCallbacks

    passes = message_filter(args.filter_expr)

    # rclpy recognizes by the two parameters that the message's info is wanted, too. Its type hints do not allow that.
    def received(msg: Any, info: dict[str, Any]) -> None:
        shown = msg if args.raw else _field_of(msg, args.field)
        if passes(shown):
            print(_text(shown, info, args))
            if args.once:
                done.set_result(None)

    callbacks = SubscriptionEventCallbacks(message_lost=None if args.no_lost_messages else _report_lost)
    profile = matching_profile(node, args, args.topic_name)
    subscribe: Any = node.create_subscription
    subscribe(message_type, args.topic_name, received, profile, event_callbacks=callbacks, raw=args.raw)


def _echo(args: argparse.Namespace) -> Outcome:
    import rclpy
    from rclpy.task import Future

    if args.field is not None and not args.field.strip("."):
        return f"Invalid field value '{args.field}'"
    with graph_node(args) as node:
        if args.message_type is None:
            message_type = message_class(node, args.topic_name)
            if message_type is None:
                return "Could not determine the type for the passed topic"
        else:
            try:
                message_type = load_type(args.message_type, "msg")
            except ValueError:
                return "The passed message type is invalid"
        done = Future()
        if args.timeout is not None:
            node.create_timer(args.timeout, lambda: done.set_result(None))
        _listen(node, message_type, args, done)
        rclpy.spin_until_future_complete(node, done)
    return None


VERBS = {"echo": Verb(_arguments, _echo)}
