"""The node with which a verb queries the graph and takes part in it."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import TERMINATED
from course_runtime.ros2_command.discovery import discover
from course_runtime.ros2_command.ports import domain_id

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from rclpy.node import Node

# Names with this prefix are hidden from lists, so that the command does not list itself.
NAME_PREFIX = "_ros2cli"
_PROFILE = Path(__file__).with_name("fastdds_profile.xml")
_LOOK, _GRACE = 0.2, 2.0  # seconds between two checks, and seconds for a verb to end by itself
_PROFILE_VARIABLES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")


def add_graph_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that all verbs have that query the graph."""
    parser.add_argument(
        "--spin-time",
        type=float,
        default=None,
        help="Spin time in seconds to wait for discovery (default: until all that is on this machine is met)",
    )
    parser.add_argument("-s", "--use-sim-time", action="store_true", help="Enable ROS simulation time")
    parser.add_argument("--no-daemon", action="store_true", help="Do not use a daemon (there is none here)")


@contextlib.contextmanager
def graph_node(
    args: argparse.Namespace | None = None, *, name: str | None = None, handle_interrupt: bool = True
) -> Iterator[Node]:
    """Start ROS with one node that knows the graph. At the end of the block, stop ROS.

    Args:
        args: The parsed command line, of which `spin_time` and `use_sim_time` are used.
        name: The name of the node; by default hidden and unique.
        handle_interrupt: True to let rclpy shut down at Ctrl-C. If False, Ctrl-C raises a KeyboardInterrupt, and ROS
            still works while it is handled.

    Raises:
        RuntimeError: ROS_DOMAIN_ID is not a valid domain.
    """
    domain_id()
    if not any(os.environ.get(variable) for variable in _PROFILE_VARIABLES):
        os.environ.update(dict.fromkeys(_PROFILE_VARIABLES, str(_PROFILE)))

    import rclpy
    from rclpy.signals import SignalHandlerOptions
    from rclpy.utilities import try_shutdown

    options = SignalHandlerOptions.ALL if handle_interrupt else SignalHandlerOptions.NO
    rclpy.init(args=[], signal_handler_options=options)
    node = _create(name, use_sim_time=getattr(args, "use_sim_time", False))
    ended = threading.Event()
    threading.Thread(target=_end_without_ros, args=(node, ended), daemon=True).start()
    try:
        if silent := discover(node, getattr(args, "spin_time", None)):
            print(
                f"WARNING: {silent} participant(s) of ROS on this machine did not answer: something may be missing",
                file=sys.stderr,
            )
        yield node
    finally:
        ended.set()
        node.destroy_node()
        try_shutdown()


def _end_without_ros(node: Node, ended: threading.Event) -> None:
    """End this process if a signal has shut down ROS and the verb does not return from a wait.

    rclpy reacts to SIGTERM by shutting down ROS, which should end every wait. Sometimes one wait does not end, and
    then `timeout 8 ros2 ...` would never end.
    """
    while not ended.wait(_LOOK):
        if not node.context.ok():
            if not ended.wait(_GRACE):
                sys.stdout.flush()
                os._exit(TERMINATED)
            return


def _create(name: str | None, *, use_sim_time: bool) -> Node:
    from rclpy.node import Node
    from rclpy.parameter import Parameter

    # The services of parameters are never called, and would take half of the start-up time.
    return Node(
        name or f"{NAME_PREFIX}_{os.getpid()}",
        start_parameter_services=False,
        parameter_overrides=[
            Parameter("use_sim_time", value=use_sim_time),
            Parameter("start_type_description_service", value=False),
        ],
        automatically_declare_parameters_from_overrides=True,
    )
