"""The table of all words: the module for each verb, and the words that only the full ros2cli has.

Finding a word imports nothing, so `ros2 -h` takes no longer than Python's start.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Mapping

# The result of a verb, as in ros2cli: None or 0 for success, another number for an exit code, a text for an error
# that is printed on stderr with exit code 1.
Outcome = int | str | None
# The exit code of ros2cli after SIGTERM: the number of the signal.
TERMINATED = 15


@dataclass(frozen=True)
class Verb:
    """One verb of a command: its arguments and its function."""

    arguments: Callable[[argparse.ArgumentParser], None]
    main: Callable[[argparse.Namespace], Outcome]


@dataclass(frozen=True)
class Word:
    """A row of the table: the help line of a verb, and the module whose `VERBS` contains the verb."""

    summary: str
    module: str

    def load(self, name: str) -> Verb:
        """Import the module, and return its verb with this name."""
        module = importlib.import_module(f"course_runtime.ros2_command.{self.module}")
        return cast("dict[str, Verb]", module.VERBS)[name]


@dataclass(frozen=True)
class Command:
    """A command: a group of verbs or, with `itself`, a command without verbs.

    Attributes:
        summary: The line in `ros2 -h`.
        verbs: The verbs that work here.
        elsewhere: The verbs that Jazzy's ros2cli has and this command does not.
        option: An option of the command that its verbs also accept, with its help.
    """

    summary: str
    verbs: Mapping[str, Word] = field(default_factory=dict)
    elsewhere: frozenset[str] = frozenset()
    itself: Word | None = None
    option: tuple[str, str] | None = None


COMMANDS: Mapping[str, Command] = {
    "action": Command(
        "Various action related sub-commands",
        {
            "info": Word("Print information about an action", "action"),
            "list": Word("Output a list of action names", "action"),
            "send_goal": Word("Send an action goal", "action_goal"),
            "type": Word("Print an action's type", "action"),
        },
        frozenset({"find"}),
    ),
    "doctor": Command("Check ROS setup and other potential issues", itself=Word("", "doctor")),
    "interface": Command(
        "Show information about ROS interfaces",
        {
            "list": Word("List all interface types available", "interface"),
            "package": Word("Output a list of available interface types within one package", "interface"),
            "packages": Word("Output a list of packages that provide interfaces", "interface"),
            "show": Word("Output the interface definition", "interface_show"),
        },
        frozenset({"proto"}),
    ),
    "launch": Command("Run a launch file", itself=Word("", "launch")),
    "node": Command(
        "Various node related sub-commands",
        {
            "info": Word("Output information about a node", "node"),
            "list": Word("Output a list of available nodes", "node"),
        },
    ),
    "param": Command(
        "Various param related sub-commands",
        {
            "describe": Word("Show descriptive information about declared parameters", "param"),
            "dump": Word("Show all of the parameters of a node in a YAML file format", "param_file"),
            "get": Word("Get parameter", "param"),
            "list": Word("Output a list of available parameters", "param"),
            "load": Word("Load parameter file for a node", "param_file"),
            "set": Word("Set parameter", "param"),
        },
        frozenset({"delete"}),
    ),
    "pkg": Command(
        "Various package related sub-commands",
        {
            "create": Word("Create a new ROS 2 package", "pkg_create"),
            "executables": Word("Output a list of package specific executables", "pkg"),
            "list": Word("Output a list of available packages", "pkg"),
            "prefix": Word("Output the prefix path of a package", "pkg"),
        },
        frozenset({"xml"}),
    ),
    "run": Command("Run a package specific executable", itself=Word("", "run")),
    "service": Command(
        "Various service related sub-commands",
        {
            "call": Word("Call a service", "service_call"),
            "find": Word("Output a list of available services of a given type", "service"),
            "info": Word("Print information about a service", "service"),
            "list": Word("Output a list of available services", "service"),
            "type": Word("Output a service's type", "service"),
        },
        frozenset({"echo"}),
        option=("--include-hidden-services", "Consider hidden services as well"),
    ),
    "topic": Command(
        "Various topic related sub-commands",
        {
            "bw": Word("Display bandwidth used by topic", "topic_traffic"),
            "delay": Word("Display delay of topic from timestamp in header", "topic_traffic"),
            "echo": Word("Output messages from a topic", "topic_echo"),
            "find": Word("Output a list of available topics of a given type", "topic"),
            "hz": Word("Print the average publishing rate to screen", "topic_traffic"),
            "info": Word("Print information about a topic", "topic"),
            "list": Word("Output a list of available topics", "topic"),
            "pub": Word("Publish a message to a topic", "topic_pub"),
            "type": Word("Print a topic's type", "topic"),
        },
        option=("--include-hidden-topics", "Consider hidden topics as well"),
    ),
}

# Commands of a full Jazzy installation that are missing here, with a hint if there is one.
ELSEWHERE: Mapping[str, str] = {
    "bag": "",
    "component": "",
    "control": "",
    "daemon": "No daemon is used here: every command looks at the graph by itself.",
    "extension_points": "",
    "extensions": "",
    "lifecycle": "",
    "multicast": "",
    "plugin": "",
    "security": "",
    "test": "",
    "trace": "",
    "wtf": "It is another name of `ros2 doctor`, which is here.",
}
