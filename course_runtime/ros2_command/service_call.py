"""`ros2 service call`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import NAME_PREFIX, graph_node
from course_runtime.ros2_command.interface_types import load_type
from course_runtime.ros2_command.messages import fill, parse_values
from course_runtime.ros2_command.values_argument import add_values_argument, given_values

if TYPE_CHECKING:
    import argparse

_POLL = 0.01  # seconds between two checks; rclpy's own wait checks only four times a second


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("service_name", help="Name of the ROS service to call to (e.g. '/add_two_ints')")
    parser.add_argument("service_type", help="Type of the ROS service (e.g. 'std_srvs/srv/Empty')")
    add_values_argument(
        parser,
        "values",
        "Values to fill the service request with in YAML format (e.g. '{a: 1, b: 2}'), otherwise the service "
        "request will be published with default values",
        "Read values from standard input",
    )
    parser.add_argument(
        "-r", "--rate", metavar="N", type=float, help="Repeat the call at a specific rate in Hz"
    )


def _call(args: argparse.Namespace) -> Outcome:
    import rclpy

    if args.rate is not None and args.rate <= 0:
        return "rate must be greater than zero"
    try:
        service = load_type(args.service_type, "srv")
    except ValueError:
        return "The passed service type is invalid"
    values = parse_values(given_values(args, "values"))
    request = service.Request()
    try:
        fill(request, values)
    except Exception as error:
        return f"Failed to populate field: {error}"
    name = f"{NAME_PREFIX}_requester_{args.service_type.replace('/', '_')}"
    with graph_node(name=name) as node:
        client = node.create_client(service, args.service_name)
        if not client.service_is_ready():
            print("waiting for service to become available...")
            while node.context.ok() and not client.service_is_ready():
                rclpy.spin_once(node, timeout_sec=_POLL)
        while node.context.ok():
            print(f"requester: making request: {request!r}\n")
            started = time.monotonic()
            future = client.call_async(request)
            rclpy.spin_until_future_complete(node, future)
            print(f"response:\n{future.result()!r}\n")
            if args.rate is None:
                break
            time.sleep(max(0.0, started + 1 / args.rate - time.monotonic()))
    return None


VERBS = {"call": Verb(_arguments, _call)}
