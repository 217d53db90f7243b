"""What a launch tells the judge of its processes: one line of JSON each, among its other output."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import TYPE_CHECKING

from autograder.exercises.evidence import REPORTS, Part

if TYPE_CHECKING:
    from collections.abc import Sequence

MARK = REPORTS[1]


def process_line(argv: Sequence[str]) -> str:
    """The line that travels."""
    return MARK + json.dumps(list(argv), ensure_ascii=False)


def processes(part: Part) -> list[list[str]]:
    """The command lines of the processes that a launch started."""
    texts = [str(event.data["text"]) for event in part.of("output")]
    return [argv for text in texts if text.startswith(MARK) and (argv := _parsed(text[len(MARK) :]))]


def _parsed(text: str) -> list[str]:
    try:
        words = json.loads(text)
    except ValueError:
        return []
    return list(map(str, words)) if isinstance(words, list) else []


def remappings(argv: Sequence[str]) -> list[tuple[str, str]]:
    """The rules ``from:=to`` that a command line hands to its node with ``-r`` or ``--remap``."""
    rules = [rule for flag, rule in pairwise(argv) if flag in ("-r", "--remap")]
    return [(old, new) for old, found, new in (rule.partition(":=") for rule in rules) if found]
