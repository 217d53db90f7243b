"""A launch's report to the judge on its processes: one line of JSON each, among its other output."""

from __future__ import annotations

import json
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from autograder.kit.evidence import REPORTS, Part

if TYPE_CHECKING:
    from collections.abc import Sequence

MARK = REPORTS[1]


@dataclass(frozen=True)
class Process:
    """A process below a launch.

    Attributes:
        pid: Its id, as it sees it itself.
        parent: The id of the process that started it, in the same way.
        argv: Its command line.
    """

    pid: int
    parent: int
    argv: tuple[str, ...]


def process_line(process: Process) -> str:
    """The line that travels."""
    return MARK + json.dumps([process.pid, process.parent, *process.argv], ensure_ascii=False)


def processes(part: Part) -> list[Process]:
    """The processes that a launch started; one that became another program has an entry for each."""
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
    """The rules ``from:=to`` that a command line hands to its node with ``-r`` or ``--remap``."""
    rules = [rule for flag, rule in pairwise(argv) if flag in ("-r", "--remap")]
    return [(old, new) for old, found, new in (rule.partition(":=") for rule in rules) if found]
