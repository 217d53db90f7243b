"""Reports on the processes that a launch started: one line of JSON each, with the command line, and what it says."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

from autograder.kit.output.spoken_lines import REPORTS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.evidence import Part


PROCESS_MARK = REPORTS[1]
"""The beginning of a line that reports a process of a launch."""


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
    return PROCESS_MARK + json.dumps([process.pid, process.parent, *process.argv], ensure_ascii=False)


def processes(part: Part) -> list[Process]:
    """Return the programs that a launch started; a process that replaced its program (exec) counts twice."""
    texts = [str(event.data["text"]) for event in part.of("output")]
    found = [_parsed_process(text[len(PROCESS_MARK) :]) for text in texts if text.startswith(PROCESS_MARK)]
    return [process for process in found if process is not None]


def all_are_there(part: Part) -> bool:
    """Return True if each program that a launch started has a topic endpoint, or an endpoint's process is unknown."""
    known = {process for survey in part.of("interface") for _, _, process in survey.data.get("ends", ())}
    started = processes(part)
    parents = {process.parent for process in started}
    return {process.pid & 0xFFFF for process in started if process.pid not in parents} <= known or 0 in known


def _parsed_process(text: str) -> Process | None:
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
    return [(old, new) for _, old, new in _placed_remappings(argv)]


def _placed_remappings(argv: Sequence[str]) -> list[tuple[range, str, str]]:
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
        if found := _OF_A_PACKAGE.search(word) or _OF_A_PACKAGE.search(_path_of_program(word, programs)):
            rules = [at for at, *rule in _placed_remappings(argv) if leads_there(*rule)]
            gone = {at for places in rules for at in places}
            gone |= {at + more for at, word in enumerate(argv) if word == "--params-file" for more in (0, 1)}
            rest = [one for at, one in enumerate(argv) if at >= place and at not in gone]
            return (found[1], found[2], *rest)
    return ()


def _path_of_program(word: str, programs: Sequence[tuple[str, str]]) -> str:
    """Return the program of a module or file, as ``package/file``; empty if the package has no such program.

    Args:
        word: The module or file in a traceback.
        programs: The module and the path of each program of the package.
    """
    file = word.removesuffix(".py") if word.endswith(".py") else word.replace(".", "/")
    return next((path for module, path in programs if f"/{file}".endswith(f"/{module}")), "")
