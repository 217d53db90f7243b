"""`ros2 launch`."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb

if TYPE_CHECKING:
    import argparse

    from launch import LaunchDescription


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-n",
        "--noninteractive",
        default=not sys.stdin.isatty(),
        action="store_true",
        help="Run the launch system non-interactively, with no terminal associated",
    )
    parser.add_argument(
        "-d",
        "--debug",
        action="store_true",
        help="Put the launch system in debug mode, provides more verbose output.",
    )
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "-p",
        "--print",
        "--print-description",
        action="store_true",
        help="Print the launch description to the console without launching it.",
    )
    group.add_argument(
        "-s",
        "--show-args",
        "--show-arguments",
        action="store_true",
        help="Show arguments that may be given to the launch file.",
    )
    parser.add_argument(
        "-a",
        "--show-all-subprocesses-output",
        action="store_true",
        help="Show all launched subprocesses' output by overriding their output configuration using the "
        "OVERRIDE_LAUNCH_PROCESS_OUTPUT envvar.",
    )
    parser.add_argument(
        "--launch-prefix",
        help="Prefix command, which should go before all executables. Command must be wrapped in quotes if "
        "it contains spaces (e.g. --launch-prefix 'xterm -e gdb -ex run --args').",
    )
    parser.add_argument(
        "--launch-prefix-filter",
        help="Regex pattern for filtering which executables the --launch-prefix is applied to by matching "
        "the executable name.",
    )
    parser.add_argument("package_name", help="Name of the ROS package which contains the launch file")
    parser.add_argument("launch_file_name", nargs="?", help="Name of the launch file")
    parser.add_argument(
        "launch_arguments",
        nargs="*",
        help="Arguments to the launch file; '<name>:=<value>' (for duplicates, last one wins)",
    )


def launch_file_in_package(package: str, file_name: str | None) -> str:
    """Return the path of a launch file that a package has installed.

    Raises:
        RuntimeError: The package or the file does not exist, or several files have this name.
    """
    from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

    try:
        share = get_package_share_directory(package)
    except (PackageNotFoundError, ValueError) as error:
        raise RuntimeError(f"Package '{package}' not found: {error}") from error
    found = sorted(str(path) for path in Path(share).rglob("*") if path.name == file_name)
    if not found:
        raise RuntimeError(
            f"file '{file_name}' was not found in the share directory of package '{package}' which is at "
            f"'{share}'"
        )
    if len(found) > 1:
        paths = ", ".join(f"'{path}'" for path in found)
        raise RuntimeError(
            f"file '{file_name}' was found more than once in the share directory of package '{package}': "
            f"[{paths}]"
        )
    return found[0]


def parse_launch_arguments(given: list[str]) -> dict[str, str]:
    """Return the values of launch arguments by name.

    Raises:
        RuntimeError: An argument does not have the form `name:=value`.
    """
    values = {}
    for argument in given:
        name, sign, value = argument.partition(":=")
        if not name or not sign or not value:
            raise RuntimeError(f"malformed launch argument '{argument}', expected format '<name>:=<value>'")
        values[name] = value
    return values


def show_arguments(description: LaunchDescription) -> None:
    """Print the arguments that a launch file accepts."""
    from launch.launch_description import declared_arguments

    print("Arguments (pass arguments as '<name>:=<value>'):")
    arguments = declared_arguments(description)
    for argument, conditional in arguments:
        print(f"\n    '{argument.name}':{'*' if conditional else ''}\n        {argument.description}")
        if argument.default_value is not None:
            default = " + ".join(part.describe() for part in argument.default_value)
            print(f"        (default: {default})")
    if not arguments:
        print("\n  No arguments.")
    elif any(conditional for _, conditional in arguments):
        print("\n* argument(s) which are only used if specific conditions occur")


def _find_launch_package() -> None:
    """Make `launch` importable, even if the environment was set up without it."""
    import importlib.util

    spec = importlib.util.find_spec("launch")
    # A package may have a folder launch/ with launch files in the search path. Python takes it for a namespace
    # package, which has no origin.
    if spec is None or spec.origin is None:
        from course_runtime.ros2_command.install import LAUNCH_FRONT

        sys.path.append(str(LAUNCH_FRONT))


def _launch(args: argparse.Namespace) -> Outcome:
    given = list(args.launch_arguments)
    if Path(args.package_name).is_file():
        path = args.package_name
        if args.launch_file_name is not None:
            # If a path is given, there is no second name, so this word is the first argument.
            given.insert(0, args.launch_file_name)
    else:
        path = launch_file_in_package(args.package_name, args.launch_file_name)
    if args.launch_prefix is None and args.launch_prefix_filter is not None:
        return "--launch-prefix must be specified if --launch-prefix-filter is provided"
    if args.show_all_subprocesses_output:
        os.environ["OVERRIDE_LAUNCH_PROCESS_OUTPUT"] = "both"
    values = parse_launch_arguments(given)
    for option in ("launch_prefix", "launch_prefix_filter"):
        if getattr(args, option) is not None:
            values[option.replace("_", "-")] = getattr(args, option)
    _find_launch_package()
    return _run(path, given, values, args)


def _run(path: str, given: list[str], values: dict[str, str], args: argparse.Namespace) -> Outcome:
    import launch
    from launch.launch_description_sources import (
        AnyLaunchDescriptionSource,
        InvalidLaunchFileError,
        get_launch_description_from_any_launch_file,
    )

    if args.print or args.show_args:
        try:
            description = get_launch_description_from_any_launch_file(path)
        except InvalidLaunchFileError as error:
            return str(error)
        if args.print:
            print(launch.LaunchIntrospector().format_launch_description(description))
        else:
            show_arguments(description)
        return None
    service = launch.LaunchService(argv=given, noninteractive=args.noninteractive, debug=args.debug)
    include = launch.actions.IncludeLaunchDescription(
        AnyLaunchDescriptionSource(path), launch_arguments=values.items()
    )
    service.include_launch_description(launch.LaunchDescription([include]))
    return service.run()


VERBS = {"launch": Verb(_arguments, _launch)}
