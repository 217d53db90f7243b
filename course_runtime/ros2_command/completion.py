"""Completion of a command line in bash and zsh, by argcomplete, as Jazzy's ros2cli has it.

The shell asks again each time Tab is pressed, so only the parsers of words that are already typed are made.
"""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.commands import COMMANDS
from course_runtime.ros2_command.graph_node import graph_node
from course_runtime.ros2_command.interface_types import interface_packages, interfaces_of
from course_runtime.ros2_command.names import is_hidden

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rclpy.node import Node

    Completer = Callable[..., Iterable[str]]


def complete() -> None:
    """Answer the shell's question and end this process. Without argcomplete, return."""
    try:
        import argcomplete
    except ImportError:
        return
    typed = os.environ.get("COMP_LINE", "").split()[1:]
    argcomplete.autocomplete(parser_for(typed), always_complete_options=False)


def parser_for(typed: list[str]) -> argparse.ArgumentParser:
    """Return a parser that knows all words, and the arguments of the command that has been typed."""
    root = argparse.ArgumentParser("ros2")
    root.add_argument("--version", action="store_true")
    commands = root.add_subparsers()
    for name, command in COMMANDS.items():
        parser = commands.add_parser(name, help=command.summary)
        if name not in typed[:1]:
            continue
        if command.itself:
            command.itself.load(name).arguments(parser)
            _add_completers(parser)
            continue
        verbs = parser.add_subparsers()
        for verb, word in command.verbs.items():
            inner = verbs.add_parser(verb, help=word.summary)
            if verb in typed[1:2]:
                word.load(verb).arguments(inner)
                _add_completers(inner)
    return root


def _add_completers(parser: argparse.ArgumentParser) -> None:
    for action in parser._actions:
        if not action.option_strings and action.dest in _COMPLETERS:
            completing: Any = action
            completing.completer = _COMPLETERS[action.dest]


def _on_graph(names: Callable[[Node], Iterable[str]]) -> Completer:
    """Return a completer that gets names from the ROS graph."""

    def completer(**_: Any) -> list[str]:
        with graph_node() as node:
            return sorted(name for name in names(node) if not is_hidden(name))

    return completer


def _actions(node: Node) -> Iterable[str]:
    from rclpy.action.graph import get_action_names_and_types

    return [name for name, _ in get_action_names_and_types(node)]


def _nodes(node: Node) -> Iterable[str]:
    return [f"{space.rstrip('/')}/{name}" for name, space in node.get_node_names_and_namespaces()]


def _types(*kinds: str) -> Completer:
    def completer(**_: Any) -> list[str]:
        return [
            f"{package}/{name}"
            for package in interface_packages()
            for kind in kinds
            for name in interfaces_of(package, kind)
        ]

    return completer


def _packages(**_: Any) -> list[str]:
    from ament_index_python import get_packages_with_prefixes

    return sorted(get_packages_with_prefixes())


def _executables(*, parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    from course_runtime.ros2_command.pkg import executable_paths, package_prefix

    package = parsed_args.package_name
    return [path.name for path in executable_paths(package)] if package_prefix(package) else []


def _launch_files(*, parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    from course_runtime.ros2_command.pkg import package_prefix

    prefix = package_prefix(parsed_args.package_name)
    share = prefix / "share" / parsed_args.package_name if prefix else None
    return sorted(path.name for path in share.rglob("*launch.*")) if share else []


def _parameters(*, parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    from rcl_interfaces.srv import ListParameters

    from course_runtime.ros2_command.names import absolute
    from course_runtime.ros2_command.param import ask

    with graph_node() as node:
        name = absolute(parsed_args.node_name)
        listed = ask(node, name, "list_parameters", ListParameters.Request(), ListParameters)
    return sorted(listed.result.names) if listed else []


_COMPLETERS: dict[str, Completer] = {
    "action_name": _on_graph(_actions),
    "action_type": _types("action"),
    "executable_name": _executables,
    "launch_file_name": _launch_files,
    "message_type": _types("msg"),
    "node_name": _on_graph(_nodes),
    "package_name": _packages,
    "parameter_name": _parameters,
    "parameter_names": _parameters,
    "service_name": _on_graph(lambda node: [name for name, _ in node.get_service_names_and_types()]),
    "service_type": _types("srv"),
    "topic_name": _on_graph(lambda node: [name for name, _ in node.get_topic_names_and_types()]),
    "topic_type": _types("msg"),
    "type": _types("msg", "srv", "action"),
}
"""The completers by the names of arguments, which are those of ros2cli."""
