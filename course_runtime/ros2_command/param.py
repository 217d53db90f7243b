"""`ros2 param list`, `describe`, `get` and `set`, which call the parameter services of a node."""

from __future__ import annotations

import re  # noqa: TID251  (not what a student handed in)
import sys
import time
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import add_graph_arguments, graph_node
from course_runtime.ros2_command.names import absolute
from course_runtime.ros2_command.node import node_names

if TYPE_CHECKING:
    import argparse

    from rclpy.node import Node

# Seconds.
_POLL = 0.01
_SERVICE_LIMIT = 5.0
_ASK_AGAIN = 1.0

# For each number of rcl_interfaces/msg/ParameterType: its name, the words before a value, and the field of the value.
_TYPES = (
    ("not set", "Parameter not set.", None),
    ("boolean", "Boolean value is:", "bool_value"),
    ("integer", "Integer value is:", "integer_value"),
    ("double", "Double value is:", "double_value"),
    ("string", "String value is:", "string_value"),
    ("byte array", "Byte values are:", "byte_array_value"),
    ("boolean array", "Boolean values are:", "bool_array_value"),
    ("integer array", "Integer values are:", "integer_array_value"),
    ("double array", "Double values are:", "double_array_value"),
    ("string array", "String values are:", "string_array_value"),
)


def ask(node: Node, node_name: str, service: str, request: Any, kind: Any) -> Any | None:
    """Call a parameter service. Return None if the service does not appear.

    A server drops its answer if it does not know the client yet (rmw_fastrtps waits 0.1 s). So a client that gets no
    answer asks again; a second request changes nothing.
    """
    import rclpy

    client = node.create_client(kind, f"{node_name}/{service}")
    limit = time.monotonic() + _SERVICE_LIMIT
    while not client.service_is_ready():
        if time.monotonic() > limit:
            return None
        time.sleep(_POLL)
    while True:
        future = client.call_async(request)
        rclpy.spin_until_future_complete(node, future, timeout_sec=_ASK_AGAIN)
        if future.done():
            return future.result()


def plain_value(given: Any) -> Any:
    """Return the value in an ``rcl_interfaces/msg/ParameterValue``; None if it is not set."""
    value_field = _TYPES[given.type][2]
    value: Any = getattr(given, value_field) if value_field else None
    return value.tolist() if hasattr(value, "tolist") else value


def timed_out(node_name: str) -> str:
    """Return the error about a node whose parameter services do not appear."""
    return f"Wait for service timed out waiting for parameter services for node {node_name}"


def find_node(node: Node, args: argparse.Namespace) -> bool:
    """Wait until the node exists, at most for the time of --timeout."""
    limit = time.monotonic() + args.timeout
    name = absolute(args.node_name)
    while name not in {n.full for n in node_names(node, hidden=args.include_hidden_nodes)}:
        if time.monotonic() > limit:
            return False
        time.sleep(_POLL)
    return True


def hidden_option(parser: argparse.ArgumentParser) -> None:
    """Add the option to find nodes whose names begin with an underscore."""
    parser.add_argument("--include-hidden-nodes", action="store_true", help="Consider hidden nodes as well")


def node_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of all verbs that ask one node: the options for the graph, and the node."""
    add_graph_arguments(parser)
    parser.add_argument("node_name", help="Name of the ROS node")
    hidden_option(parser)


def _parameter_arguments(parser: argparse.ArgumentParser) -> None:
    node_arguments(parser)
    parser.add_argument("parameter_name", help="Name of the parameter")


def timeout_option(parser: argparse.ArgumentParser) -> None:
    """Add the option for the time to wait for the node."""
    parser.add_argument(
        "--timeout",
        metavar="N",
        type=int,
        default=1,
        help="Wait for N seconds until node becomes available (default %(default)s sec)",
    )


def _list_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("node_name", nargs="?", help="Name of the ROS node")
    parser.add_argument(
        "--filter",
        help="Only parameters matching the regex expression will be showed. Supports `re` regex syntax.",
    )
    hidden_option(parser)
    parser.add_argument(
        "--param-prefixes", nargs="+", default=[], help="Only list parameters with the provided prefixes"
    )
    parser.add_argument(
        "--param-type", action="store_true", help="Print parameter types with parameter names"
    )


def _descriptors(node: Node, node_name: str, names: list[str]) -> list[Any]:
    from rcl_interfaces.srv import DescribeParameters

    request = DescribeParameters.Request(names=names)
    response = ask(node, node_name, "describe_parameters", request, DescribeParameters)
    if response is None:
        raise RuntimeError(timed_out(node_name))
    return list(response.descriptors)


def _list(args: argparse.Namespace) -> Outcome:
    from rcl_interfaces.srv import ListParameters

    with graph_node(args) as node:
        names = [n.full for n in node_names(node, hidden=args.include_hidden_nodes)]
        if args.node_name:
            if absolute(args.node_name) not in names:
                return "Node not found"
            names = [absolute(args.node_name)]
        for name in names:
            request = ListParameters.Request(prefixes=args.param_prefixes)
            response = ask(node, name, "list_parameters", request, ListParameters)
            if response is None:
                print(timed_out(name))
                continue
            found = sorted(p for p in response.result.names if not args.filter or re.match(args.filter, p))
            if found and not args.node_name:
                print(f"{name}:")
            described = _descriptors(node, name, found) if args.param_type else []
            for i, parameter in enumerate(found):
                kind = f" (type: {_TYPES[described[i].type][0]})" if args.param_type else ""
                print(f"  {parameter}{kind}")
    return None


def _describe_arguments(parser: argparse.ArgumentParser) -> None:
    node_arguments(parser)
    parser.add_argument("parameter_names", nargs="+", help="Names of the parameters")
    timeout_option(parser)


def _describe(args: argparse.Namespace) -> Outcome:
    with graph_node(args) as node:
        if not find_node(node, args):
            return "Node not found"
        described = _descriptors(node, absolute(args.node_name), args.parameter_names)
    for one in described:
        print(f"Parameter name: {one.name}\n  Type: {_TYPES[one.type][0]}")
        if one.description:
            print(f"  Description: {one.description}")
        print("  Constraints:")
        if one.read_only:
            print("    Read only: true")
        for allowed in [*one.floating_point_range, *one.integer_range][:1]:
            print(f"    Min value: {allowed.from_value}\n    Max value: {allowed.to_value}")
            if allowed.step:
                print(f"    Step: {allowed.step}")
        if one.additional_constraints:
            print(f"    Additional constraints: {one.additional_constraints}")
    return None


def _get_arguments(parser: argparse.ArgumentParser) -> None:
    _parameter_arguments(parser)
    parser.add_argument("--hide-type", action="store_true", help="Hide the type information")
    timeout_option(parser)


def _get(args: argparse.Namespace) -> Outcome:
    from rcl_interfaces.srv import GetParameters

    with graph_node(args) as node:
        if not find_node(node, args):
            return "Node not found"
        request = GetParameters.Request(names=[args.parameter_name])
        response = ask(node, absolute(args.node_name), "get_parameters", request, GetParameters)
    if response is None:
        return timed_out(args.node_name)
    if not response.values:
        return "Parameter not set"
    _, words, value_field = _TYPES[response.values[0].type]
    value = plain_value(response.values[0])
    if args.hide_type:
        print(value)
    elif value_field:
        print(words, value)
    else:
        print(words)
    return None


def _set_arguments(parser: argparse.ArgumentParser) -> None:
    _parameter_arguments(parser)
    parser.add_argument("value", help="Value of the parameter")
    timeout_option(parser)


def _set(args: argparse.Namespace) -> Outcome:
    from rcl_interfaces.msg import Parameter
    from rcl_interfaces.srv import SetParameters
    from rclpy.parameter import get_parameter_value

    parameter = Parameter(name=args.parameter_name, value=get_parameter_value(args.value))
    with graph_node(args) as node:
        if not find_node(node, args):
            return "Node not found"
        request = SetParameters.Request(parameters=[parameter])
        response = ask(node, absolute(args.node_name), "set_parameters", request, SetParameters)
    if response is None:
        return timed_out(args.node_name)
    result = response.results[0]
    reason = f": {result.reason}" if result.reason else ""
    if result.successful:
        print(f"Set parameter successful{reason}")
    else:
        print(f"Setting parameter failed{reason}", file=sys.stderr)
    return None


VERBS = {
    "describe": Verb(_describe_arguments, _describe),
    "get": Verb(_get_arguments, _get),
    "list": Verb(_list_arguments, _list),
    "set": Verb(_set_arguments, _set),
}
