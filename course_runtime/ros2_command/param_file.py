"""`ros2 param dump` and `load`: the parameters of a node as a YAML file."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import graph_node
from course_runtime.ros2_command.names import absolute
from course_runtime.ros2_command.param import (
    ask,
    find_node,
    node_arguments,
    plain_value,
    timed_out,
    timeout_option,
)

if TYPE_CHECKING:
    import argparse


def _dump_arguments(parser: argparse.ArgumentParser) -> None:
    node_arguments(parser)
    timeout_option(parser)


def _dump(args: argparse.Namespace) -> Outcome:
    import yaml
    from rcl_interfaces.srv import GetParameters, ListParameters

    name = absolute(args.node_name)
    with graph_node(args) as node:
        if not find_node(node, args):
            return "Node not found"
        listed = ask(node, name, "list_parameters", ListParameters.Request(), ListParameters)
        if listed is None:
            return timed_out(name)
        names = sorted(listed.result.names)
        got = ask(node, name, "get_parameters", GetParameters.Request(names=names), GetParameters)
    if got is None:
        return timed_out(name)
    parameters: dict[str, Any] = {}
    for parameter, value in zip(names, got.values, strict=True):
        *groups, last = parameter.split(".")
        inner = parameters
        for group in groups:
            inner = inner.setdefault(group, {})
        inner[last] = plain_value(value)
    print(yaml.dump({name: {"ros__parameters": parameters}}, default_flow_style=False))
    return None


def _load_arguments(parser: argparse.ArgumentParser) -> None:
    node_arguments(parser)
    parser.add_argument("parameter_file", help="Parameter file")
    parser.add_argument(
        "--no-use-wildcard",
        action="store_true",
        help="Do not load parameters in the '/**' namespace into the node",
    )
    timeout_option(parser)


def _load(args: argparse.Namespace) -> Outcome:
    import yaml
    from rcl_interfaces.srv import SetParameters
    from rclpy.parameter import parameter_dict_from_yaml_file

    name = absolute(args.node_name)
    try:
        found = parameter_dict_from_yaml_file(
            args.parameter_file, use_wildcard=not args.no_use_wildcard, target_nodes=[name]
        )
    except (OSError, UnicodeDecodeError) as error:
        return f"The file {args.parameter_file} cannot be read: {error}"
    except (yaml.YAMLError, AttributeError, TypeError) as error:
        return (
            f"{args.parameter_file} is not a file of parameters ({error}). "
            f"`ros2 param dump {args.node_name}` prints one."
        )
    parameters = list(found.values())
    with graph_node(args) as node:
        if not find_node(node, args):
            return "Node not found"
        response = ask(
            node, name, "set_parameters", SetParameters.Request(parameters=parameters), SetParameters
        )
    if response is None:
        return timed_out(name)
    for parameter, result in zip(parameters, response.results, strict=True):
        reason = f": {result.reason}" if result.reason else ""
        if result.successful:
            print(f"Set parameter {parameter.name} successful{reason}")
        else:
            print(f"Set parameter {parameter.name} failed{reason}", file=sys.stderr)
    return None


VERBS = {"dump": Verb(_dump_arguments, _dump), "load": Verb(_load_arguments, _load)}
