"""The node with which a verb looks at the graph and takes part in it."""

from __future__ import annotations

import contextlib
import functools
import os
from typing import TYPE_CHECKING

from environment.ros2_command.discovery import (
    PATIENCE,
    domain_id,
    look,
    participants_here,
    ports_in_use,
    shortest_wait,
    wait_until_known,
)
from environment.ros2_command.participant import threads_wait_for_creator

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from rclpy.node import Node

# Names that begin with this are hidden from the lists, so that the command does not list itself.
NAME_PREFIX = "_ros2cli"


def add_graph_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of all verbs that look at the graph."""
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
    args: argparse.Namespace | None = None,
    *,
    name: str | None = None,
    discover: bool = True,
    names: bool = True,
    handle_interrupt: bool = True,
) -> Iterator[Node]:
    """Start ROS with one node, and stop it again.

    Args:
        args: the parsed command line; `spin_time` and `use_sim_time` are looked at.
        name: the node's name; hidden and unique by default.
        discover: wait until the graph is known.
        names: the names of the nodes are needed too.
        handle_interrupt: let rclpy shut down on Ctrl-C; without it Ctrl-C is a KeyboardInterrupt and ROS
            still works while it is handled.
    """
    import rclpy
    from rclpy.signals import SignalHandlerOptions
    from rclpy.utilities import try_shutdown

    others = participants_here(domain_id(), ports_in_use())
    expected = None if others is None else others + 1
    options = SignalHandlerOptions.ALL if handle_interrupt else SignalHandlerOptions.NO
    rclpy.init(args=[], signal_handler_options=options)
    node = _create(name, use_sim_time=getattr(args, "use_sim_time", False))
    try:
        shortest = shortest_wait(getattr(args, "spin_time", None), expected)
        for longest in PATIENCE if discover else ():
            if wait_until_known(
                functools.partial(look, node), expected, shortest, names=names, longest=longest
            ):
                break
            if longest != PATIENCE[-1]:
                node.destroy_node()
                node = _create(name, use_sim_time=getattr(args, "use_sim_time", False))
        yield node
    finally:
        node.destroy_node()
        try_shutdown()


def _create(name: str | None, *, use_sim_time: bool) -> Node:
    from rclpy.node import Node
    from rclpy.parameter import Parameter

    with threads_wait_for_creator():
        # Services that nobody calls here cost half of the start-up time.
        return Node(
            name or f"{NAME_PREFIX}_{os.getpid()}",
            start_parameter_services=False,
            parameter_overrides=[
                Parameter("use_sim_time", value=use_sim_time),
                Parameter("start_type_description_service", value=False),
            ],
            automatically_declare_parameters_from_overrides=True,
        )
