"""`ros2 node list` and `info`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import add_graph_arguments, graph_node
from course_runtime.ros2_command.names import NodeName, is_hidden

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable

    from rclpy.node import Node


def node_names(node: Node, *, hidden: bool) -> list[NodeName]:
    """Return the nodes on the graph, in the order of their full names."""
    nodes = [NodeName(*pair) for pair in node.get_node_names_and_namespaces()]
    return sorted((n for n in nodes if hidden or not n.hidden), key=lambda n: n.full)


def _list_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("-a", "--all", action="store_true", help="Display all nodes even hidden ones")
    parser.add_argument(
        "-c", "--count-nodes", action="store_true", help="Only display the number of nodes discovered"
    )


def _list(args: argparse.Namespace) -> Outcome:
    with graph_node(args) as node:
        names = [n.full for n in node_names(node, hidden=args.all)]
    if args.count_nodes:
        print(len(names))
        return None
    if len(set(names)) < len(names):
        print(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, which can have "
            "unintended side effects.",
            file=sys.stderr,
        )
    for name in names:
        print(name)
    return None


def _info_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("node_name", help="Node name to request information")
    parser.add_argument(
        "--include-hidden", action="store_true", help="Display hidden topics, services, and actions as well"
    )


def _sections(node: Node) -> list[tuple[str, Callable[[str, str], list[tuple[str, list[str]]]]]]:
    from rclpy.action.graph import (
        get_action_client_names_and_types_by_node,
        get_action_server_names_and_types_by_node,
    )

    return [
        ("Subscribers", node.get_subscriber_names_and_types_by_node),
        ("Publishers", node.get_publisher_names_and_types_by_node),
        ("Service Servers", node.get_service_names_and_types_by_node),
        ("Service Clients", node.get_client_names_and_types_by_node),
        ("Action Servers", lambda *of: get_action_server_names_and_types_by_node(node, *of)),
        ("Action Clients", lambda *of: get_action_client_names_and_types_by_node(node, *of)),
    ]


def _info(args: argparse.Namespace) -> Outcome:
    with graph_node(args) as node:
        found = [n for n in node_names(node, hidden=args.include_hidden) if n.full == args.node_name]
        if not found:
            return f"Unable to find node '{args.node_name}'"
        if len(found) > 1:
            print(
                f'There are {len(found)} nodes in the graph with the exact name "{args.node_name}". You are '
                "seeing information about only one of them.",
                file=sys.stderr,
            )
        print(args.node_name)
        for title, ask in _sections(node):
            print(f"  {title}:")
            lines = [
                f"    {name}: {', '.join(types)}"
                for name, types in ask(found[0].name, found[0].namespace)
                if args.include_hidden or not is_hidden(name)
            ]
            # As in ros2cli, an empty section is a single empty line.
            print(*lines, sep="\n")
    return None


VERBS = {"info": Verb(_info_arguments, _info), "list": Verb(_list_arguments, _list)}
