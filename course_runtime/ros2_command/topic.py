"""`ros2 topic list`, `info`, `type` and `find`: what the graph says about topics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import add_graph_arguments, graph_node
from course_runtime.ros2_command.names import is_hidden, show

if TYPE_CHECKING:
    import argparse

    from rclpy.node import Node

NamesAndTypes = list[tuple[str, list[str]]]


def add_hidden_option(parser: argparse.ArgumentParser) -> None:
    """Add the option to show hidden topics, such as those of actions."""
    parser.add_argument("--include-hidden-topics", action="store_true", help="Consider hidden topics as well")


def names_and_types(node: Node, *, hidden: bool) -> NamesAndTypes:
    """Return each topic on the graph with its types, in the order of the names."""
    return [(n, t) for n, t in node.get_topic_names_and_types() if hidden or not is_hidden(n)]


def _list_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the topic type")
    parser.add_argument(
        "-c", "--count-topics", action="store_true", help="Only display the number of topics discovered"
    )
    add_hidden_option(parser)
    parser.add_argument("-v", "--verbose", action="store_true", help="List full details about each topic")


def _details(title: str, noun: str, counted: list[tuple[str, list[str], int]]) -> str:
    lines = [
        f" * {name} [{', '.join(types)}] {count} {noun}{'s' if count > 1 else ''}\n"
        for name, types, count in counted
        if count
    ]
    return f"{title} topics:\n{''.join(lines)}"


def _list(args: argparse.Namespace) -> Outcome:
    with graph_node(args) as node:
        topics = names_and_types(node, hidden=args.include_hidden_topics)
        publishers = [(name, types, node.count_publishers(name)) for name, types in topics]
        subscribers = [(name, types, node.count_subscribers(name)) for name, types in topics]
    if topics and args.verbose and not args.count_topics:
        print(_details("Published", "publisher", publishers))
        print(_details("Subscribed", "subscriber", subscribers))
    else:
        show(topics, count=args.count_topics, types=args.show_types)
    return None


def _info_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to get info (e.g. '/chatter')")
    parser.add_argument(
        "--verbose",
        "-v",
        action="store_true",
        help="Prints detailed information like the node name, node namespace, topic type, topic type hash, "
        "GUID, and QoS Profile of the publishers and subscribers to this topic",
    )


def _info(args: argparse.Namespace) -> Outcome:
    end = "\n\n" if args.verbose else "\n"
    with graph_node(args) as node:
        types = dict(names_and_types(node, hidden=True)).get(args.topic_name)
        if types is None:
            return f"Unknown topic '{args.topic_name}'"
        print(f"Type: {types[0] if len(types) == 1 else types}", end=end)
        for noun, count, infos in (
            ("Publisher", node.count_publishers, node.get_publishers_info_by_topic),
            ("Subscription", node.count_subscribers, node.get_subscriptions_info_by_topic),
        ):
            print(f"{noun} count: {count(args.topic_name)}", end=end)
            for info in infos(args.topic_name) if args.verbose else ():
                print(info, end=end)
    return None


def _type_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to get type (e.g. '/chatter')")
    add_hidden_option(parser)


def _type(args: argparse.Namespace) -> Outcome:
    with graph_node(args) as node:
        types = dict(names_and_types(node, hidden=args.include_hidden_topics)).get(args.topic_name)
    for name in types or ():
        print(name)
    return 0 if types else 1


def _find_arguments(parser: argparse.ArgumentParser) -> None:
    add_graph_arguments(parser)
    parser.add_argument(
        "topic_type", help="Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')"
    )
    parser.add_argument(
        "-c", "--count-topics", action="store_true", help="Only display the number of topics discovered"
    )
    add_hidden_option(parser)


def _find(args: argparse.Namespace) -> Outcome:
    with graph_node(args) as node:
        topics = names_and_types(node, hidden=args.include_hidden_topics)
    show([(name, types) for name, types in topics if args.topic_type in types], count=args.count_topics)
    return None


VERBS = {
    "find": Verb(_find_arguments, _find),
    "info": Verb(_info_arguments, _info),
    "list": Verb(_list_arguments, _list),
    "type": Verb(_type_arguments, _type),
}
