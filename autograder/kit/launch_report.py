"""How a launch reports its processes to the judge: one line of JSON for each, among its other output."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.kit.evidence import REPORTS, Part

if TYPE_CHECKING:
    from collections.abc import Sequence

MARK = REPORTS[1]


@dataclass(frozen=True)
class Process:
    """A process that a launch started.

    Attributes:
        pid: The process id, in the PID namespace of the process itself.
        parent: The id of the parent process, in the same namespace.
        argv: The command line of the process.
    """

    pid: int
    parent: int
    argv: tuple[str, ...]


def process_line(process: Process) -> str:
    """Return the line that reports a process."""
    return MARK + json.dumps([process.pid, process.parent, *process.argv], ensure_ascii=False)


def processes(part: Part) -> list[Process]:
    """Return the processes that a launch started. A process that replaced its program (exec) has an entry for each."""
    texts = [str(event.data["text"]) for event in part.of("output")]
    found = [_parsed(text[len(MARK) :]) for text in texts if text.startswith(MARK)]
    return [process for process in found if process is not None]


def _parsed(text: str) -> Process | None:
    try:
        words = json.loads(text)
    except (ValueError, RecursionError):
        return None
    match words:
        case [int(pid), int(parent), *argv] if argv:
            return Process(pid, parent, tuple(map(str, argv)))
    return None


def remappings(argv: Sequence[str]) -> list[tuple[str, str]]:
    """Return the remapping rules ``from:=to`` that a command line passes to its node."""
    return [(old, new) for _, old, new in placed_remappings(argv)]


def placed_remappings(argv: Sequence[str]) -> list[tuple[range, str, str]]:
    """Return the remapping rules ``from:=to`` of a command line, each with the range of arguments that make it up.

    After ``--ros-args`` a rule follows ``-r`` or ``--remap``. Elsewhere an argument ``from:=to`` alone is a rule: rcl
    calls that form deprecated, but obeys it (rcl/arguments.h).
    """
    found, of_ros = [], False
    for place, word in enumerate(argv):
        if word in ("--ros-args", "--"):
            of_ros = word == "--ros-args"
        flagged = place > 0 and argv[place - 1] in ("-r", "--remap")
        old, is_rule, new = word.partition(":=")
        if is_rule and (flagged or not of_ros):
            found.append((range(place - flagged, place + 1), old, new))
    return found
