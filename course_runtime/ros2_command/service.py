"""`ros2 service list`, `info`, `type` and `find`: what the graph says about services."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import add_graph_arguments, graph_node
from course_runtime.ros2_command.names import is_hidden, show

if TYPE_CHECKING:
    import argparse


def _hidden_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--include-hidden-services", action="store_true", help="Consider hidden services as well"
    )


def _count_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-c", "--count-services", action="store_true", help="Only display the number of services discovered"
    )


def _services(args: argparse.Namespace) -> list[tuple[str, list[str]]]:
    with graph_node(args) as node:
        return [
            (name, types)
            for name, types in node.get_service_names_and_types()
            if args.include_hidden_services or not is_hidden(name)
        ]


def _list_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the service type")
    _count_option(parser)
    _hidden_option(parser)


def _list(args: argparse.Namespace) -> Outcome:
    show(_services(args), count=args.count_services, types=args.show_types)
    return None


def _type_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument(
        "service_name", help="Name of the ROS service to get type (e.g. '/talker/list_parameters')"
    )
    _hidden_option(parser)


def _type(args: argparse.Namespace) -> Outcome:
    types = dict(_services(args)).get(args.service_name)
    for name in types or ():
        print(name)
    return 0 if types else 1


def _info_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("service_name", help="Name of the ROS service to get info (e.g. '/add_two_ints')")
    _hidden_option(parser)


def _info(args: argparse.Namespace) -> Outcome:
    with graph_node(args) as node:
        types = dict(node.get_service_names_and_types()).get(args.service_name)
        if types is None:
            return f"Unknown service '{args.service_name}'"
        print(f"Type: {types[0] if len(types) == 1 else types}")
        print(f"Clients count: {node.count_clients(args.service_name)}")
        print(f"Services count: {node.count_services(args.service_name)}")
    return None


def _find_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument(
        "service_type",
        help="Name of the ROS service type to filter for (e.g. 'rcl_interfaces/srv/ListParameters')",
    )
    _count_option(parser)
    _hidden_option(parser)


def _find(args: argparse.Namespace) -> Outcome:
    found = [(name, types) for name, types in _services(args) if args.service_type in types]
    show(found, count=args.count_services)
    return None


VERBS = {
    "find": Verb(_find_arguments, _find),
    "info": Verb(_info_arguments, _info),
    "list": Verb(_list_arguments, _list),
    "type": Verb(_type_arguments, _type),
}
