"""`ros2 doctor`: checks of the environment, the network and the graph, and a report.

The real command also compares the versions of all packages with the distribution's index, for which it needs the
Internet. This check is missing here.
"""

from __future__ import annotations

import os
import platform
import socket
import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import graph_node

if TYPE_CHECKING:
    import argparse

    from rclpy.node import Node

# Every node has these topics, so a publisher without a subscriber is normal there.
_EVERYBODYS = frozenset({"/parameter_events", "/rosout"})


@dataclass
class Findings:
    """The findings of one check."""

    errors: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Section:
    """A part of the report: its title, and its lines as pairs of a name and a text."""

    title: str
    lines: list[tuple[str, str]]


def _arguments(parser: argparse.ArgumentParser) -> None:
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--report", "-r", action="store_true", help="Print all reports.")
    group.add_argument(
        "--report-failed", "-rf", action="store_true", help="Print reports of failed checks only."
    )
    parser.add_argument(
        "--exclude-packages",
        "-ep",
        action="store_true",
        help="Exclude package checks or report (they are always excluded here).",
    )
    parser.add_argument(
        "--include-warnings",
        "-iw",
        action="store_true",
        help="Include warnings as failed checks. Warnings are ignored by default.",
    )


def check_platform() -> Findings:
    """Check that the environment names the distribution."""
    distribution = os.environ.get("ROS_DISTRO")
    if not distribution:
        return Findings(errors=["ROS_DISTRO is not set."])
    if distribution.lower() != "jazzy":
        return Findings(warnings=[f"ROS_DISTRO is {distribution}; this course is about jazzy."])
    return Findings()


def check_network() -> Findings:
    """Check that the machine has a network in addition to the loopback interface."""
    names = [name for _, name in socket.if_nameindex()]
    if "lo" not in names:
        return Findings(errors=["No loopback IP address is found."])
    if names == ["lo"]:
        return Findings(warnings=["Only loopback IP address is found."])
    return Findings()


def check_topics(node: Node) -> Findings:
    """Find topics that have only publishers or only subscriptions."""
    found = Findings()
    for name in _topics(node):
        publishers, subscribers = node.count_publishers(name), node.count_subscribers(name)
        if publishers and not subscribers:
            found.warnings.append(f"Publisher without subscriber detected on {name}.")
        elif subscribers and not publishers:
            found.warnings.append(f"Subscriber without publisher detected on {name}.")
    return found


def check_quality(node: Node) -> Findings:
    """Find pairs of endpoints whose quality of service does not match."""
    from rclpy.qos import QoSCompatibility, qos_check_compatible

    found = Findings()
    for name in _topics(node):
        for publisher in node.get_publishers_info_by_topic(name):
            for subscriber in node.get_subscriptions_info_by_topic(name):
                result, reason = qos_check_compatible(publisher.qos_profile, subscriber.qos_profile)
                text = reason.partition(": ")[2] or reason
                if result == QoSCompatibility.ERROR:
                    found.errors.append(f"QoS compatibility error found on topic '{name}': {text}")
                elif result == QoSCompatibility.WARNING:
                    found.warnings.append(f"QoS compatibility warning found on topic '{name}': {text}")
    return found


def _topics(node: Node) -> list[str]:
    return [name for name, _ in node.get_topic_names_and_types() if name not in _EVERYBODYS]


def report(node: Node) -> dict[str, list[Section]]:
    """Return the sections of the report, by the categories of the checks."""
    from rclpy.utilities import get_rmw_implementation_identifier

    topics = [
        line
        for name in _topics(node)
        for line in (
            ("topic", name),
            ("publisher count", str(node.count_publishers(name))),
            ("subscriber count", str(node.count_subscribers(name))),
        )
    ]
    return {
        "platform": [
            Section(
                "PLATFORM INFORMATION",
                [
                    ("system", platform.system()),
                    ("platform info", platform.platform()),
                    ("release", platform.release()),
                    ("processor", platform.machine()),
                    ("python", platform.python_version()),
                ],
            ),
            Section(
                "ROS 2 INFORMATION",
                [
                    ("distribution name", os.environ.get("ROS_DISTRO", "not set")),
                    ("domain id", os.environ.get("ROS_DOMAIN_ID", "0")),
                    ("discovery range", os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")),
                ],
            ),
        ],
        "network": [
            Section("NETWORK CONFIGURATION", [("device", name) for _, name in socket.if_nameindex()])
        ],
        "middleware": [Section("RMW MIDDLEWARE", [("middleware name", get_rmw_implementation_identifier())])],
        "topic": [Section("TOPIC LIST", topics or [("topic", "none")])],
    }


def _show(sections: list[Section]) -> None:
    for section in sections:
        print(f"\n   {section.title}")
        width = max((len(name) for name, _ in section.lines), default=0)
        width = width + 4 if width >= 8 else 8
        for name, text in section.lines:
            print(f"{name:{width}}: {text}")


def _doctor(args: argparse.Namespace) -> Outcome:
    with graph_node() as node:
        if args.report:
            for sections in report(node).values():
                _show(sections)
            return None
        checks = {
            "platform": check_platform(),
            "network": check_network(),
            "topic": check_topics(node),
            "middleware": check_quality(node),
        }
        sections_of = report(node)
    failed = []
    for category, result in checks.items():
        for text in [*(f"ERROR: {error}" for error in result.errors), *result.warnings]:
            print(f"ros2doctor: UserWarning: {text}", file=sys.stderr)
        if result.errors or (args.include_warnings and result.warnings):
            failed.append(category)
    if failed:
        print(f"\n{len(failed)}/{len(checks)} check(s) failed\n")
        print("Failed modules:", *failed)
    else:
        print(f"\nAll {len(checks)} checks passed\n")
    if args.report_failed:
        for category in failed:
            _show(sections_of[category])
    return None


VERBS = {"doctor": Verb(_arguments, _doctor)}
