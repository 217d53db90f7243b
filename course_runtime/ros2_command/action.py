"""`ros2 action list`, `type` and `info`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import add_graph_arguments, graph_node
from course_runtime.ros2_command.names import show
from course_runtime.ros2_command.node import node_names

if TYPE_CHECKING:
    import argparse


def _list_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the action type")
    parser.add_argument(
        "-c", "--count-actions", action="store_true", help="Only display the number of actions discovered"
    )


def _actions(args: argparse.Namespace) -> list[tuple[str, list[str]]]:
    with graph_node(args) as node:
        from rclpy.action.graph import get_action_names_and_types

        return get_action_names_and_types(node)


def _list(args: argparse.Namespace) -> Outcome:
    show(_actions(args), count=args.count_actions, types=args.show_types)
    return None


def _type_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("action_name", help="Name of the ROS action to get type (e.g. '/fibonacci')")


def _type(args: argparse.Namespace) -> Outcome:
    types = dict(_actions(args)).get(args.action_name)
    for name in types or ():
        print(name)
    return 0 if types else 1


def _info_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("action_name", help="Name of the ROS action to get info (e.g. '/fibonacci')")
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the action type")
    parser.add_argument(
        "-c",
        "--count",
        action="store_true",
        help="Only display the number of action clients and action servers",
    )


def _info(args: argparse.Namespace) -> Outcome:
    sides: list[tuple[str, list[tuple[str, list[str]]]]] = []
    with graph_node(args) as node:
        from rclpy.action.graph import (
            get_action_client_names_and_types_by_node,
            get_action_server_names_and_types_by_node,
        )
        from rclpy.exceptions import InvalidTopicNameException
        from rclpy.expand_topic_name import expand_topic_name
        from rclpy.validate_full_topic_name import validate_full_topic_name

        try:
            action = expand_topic_name(args.action_name, node.get_name(), node.get_namespace())
            validate_full_topic_name(action)
        except (ValueError, InvalidTopicNameException) as error:
            return str(error)
        nodes = node_names(node, hidden=True)
        for side, ask in (
            ("clients", get_action_client_names_and_types_by_node),
            ("servers", get_action_server_names_and_types_by_node),
        ):
            found = [
                (n.full, types)
                for n in nodes
                for name, types in ask(node, n.name, n.namespace)
                if name == action
            ]
            sides.append((side, found))
    print(f"Action: {args.action_name}")
    for side, found in sides:
        print(f"Action {side}: {len(found)}")
        for name, types in () if args.count else found:
            print(f"    {name} [{', '.join(types)}]" if args.show_types else f"    {name}")
    return None


VERBS = {
    "info": Verb(_info_arguments, _info),
    "list": Verb(_list_arguments, _list),
    "type": Verb(_type_arguments, _type),
}
