"""Reads the lines in which a launch reports its processes, and the remapping rules in their command lines."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

from autograder.kit.evidence import REPORTS, Part

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

MARK = REPORTS[1]


@dataclass(frozen=True)
class Process:
    """A process that a launch started.

    Attributes:
        pid: The process id, as the process itself sees it in its PID namespace.
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
    """Return the programs that a launch started; a process that replaced its program (exec) counts twice."""
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
    """Return the remapping rules ``from:=to`` of a command line, as pairs of names."""
    return [(old, new) for _, old, new in placed_remappings(argv)]


def placed_remappings(argv: Sequence[str]) -> list[tuple[range, str, str]]:
    """Return the remapping rules ``from:=to`` of a command line, each with the indexes of its arguments.

    After ``--ros-args``, a rule follows ``-r`` or ``--remap``. Before it, an argument ``from:=to`` alone is a rule: rcl
    calls this form deprecated, but obeys it (rcl/arguments.h).
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


_OF_A_PACKAGE = re2.compile(r"/lib/(\w[\w-]{0,60})/(\w[\w.-]{0,60})$")
"""Matches the end of the path of an installed program: its package and its name."""


def as_run(
    argv: Sequence[str], programs: Sequence[tuple[str, str]], leads_there: Callable[[str, str], bool]
) -> tuple[str, ...]:
    """Return the arguments with which ``ros2 run`` would start a process; empty if it is not a program of a package.

    Files of parameters are left out, because a launch writes them and removes them when it ends.

    Args:
        argv: The command line of a process.
        programs: For each program of the workspace, its module with slashes instead of dots, and the end of its path.
        leads_there: Decides, for the two names of a remapping rule, whether the rule is left out.
    """
    # A prefix, such as `python3 -u`, may precede the program.
    own = argv[: argv.index("--ros-args")] if "--ros-args" in argv else argv
    for place, word in enumerate(own, 1):
        if found := _OF_A_PACKAGE.search(word) or _OF_A_PACKAGE.search(_program(word, programs)):
            rules = [at for at, *rule in placed_remappings(argv) if leads_there(*rule)]
            gone = {at for places in rules for at in places}
            gone |= {at + more for at, word in enumerate(argv) if word == "--params-file" for more in (0, 1)}
            rest = [one for at, one in enumerate(argv) if at >= place and at not in gone]
            return (found[1], found[2], *rest)
    return ()


def _program(word: str, programs: Sequence[tuple[str, str]]) -> str:
    """Return the last parts of the path of the program that a module or file defines; empty if it defines none."""
    file = word.removesuffix(".py") if word.endswith(".py") else word.replace(".", "/")
    return next((path for module, path in programs if f"/{file}".endswith(f"/{module}")), "")
