"""`ros2 interface list`, `package` and `packages`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.interface_types import interface_packages, interfaces_of

if TYPE_CHECKING:
    import argparse

_KINDS = (
    ("msg", "Messages", "only_msgs"),
    ("srv", "Services", "only_srvs"),
    ("action", "Actions", "only_actions"),
)


def _kind_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-m", "--only-msgs", action="store_true", help="Print out only the message types")
    parser.add_argument("-s", "--only-srvs", action="store_true", help="Print out only the service types")
    parser.add_argument("-a", "--only-actions", action="store_true", help="Print out only the action types")


def _chosen(args: argparse.Namespace) -> list[tuple[str, str]]:
    """Return the requested kinds of interfaces, each with its title; all kinds if none was requested."""
    chosen = [(kind, title) for kind, title, option in _KINDS if getattr(args, option)]
    return chosen or [(kind, title) for kind, title, _ in _KINDS]


def _list(args: argparse.Namespace) -> Outcome:
    packages = interface_packages()
    for kind, title in _chosen(args):
        print(f"{title}:")
        for package in packages:
            for name in interfaces_of(package, kind):
                print(f"    {package}/{name}")
    return None


def _package_arguments(parser: argparse.ArgumentParser) -> None:
    _kind_arguments(parser)
    parser.add_argument("package_name", help="Name of the ROS package (e.g. 'example_interfaces')")


def _package(args: argparse.Namespace) -> Outcome:
    try:
        for kind, _ in _chosen(args):
            for name in interfaces_of(args.package_name, kind):
                print(f"{args.package_name}/{name}")
    except LookupError as error:
        return str(error)
    return None


def _packages(args: argparse.Namespace) -> Outcome:
    kinds = [kind for kind, _ in _chosen(args)]
    for package in interface_packages():
        if any(interfaces_of(package, kind) for kind in kinds):
            print(package)
    return None


VERBS = {
    "list": Verb(_kind_arguments, _list),
    "package": Verb(_package_arguments, _package),
    "packages": Verb(_kind_arguments, _packages),
}
