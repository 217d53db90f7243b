"""Exceptions that a program raises in order to say something, told from slips."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.crashes import OTHER_CRASHES, traceback_of

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence
    from autograder.kit.model import Advice, Mistake

_FRAME = re2.compile(r'(?m)^ {2}File "(?P<file>[^"]*)", line \d+.*\n {4,}(?P<code>\S.*)$')
_LIBRARY = re2.compile(r"/(site|dist)-packages/|/lib/python3\.\d+/|/opt/ros/")


def meant(traceback: str) -> bool:
    """Whether the innermost line of a traceback is one of the program's own that says ``raise`` or ``assert``."""
    frames = list(_FRAME.finditer(traceback))
    if not frames or _LIBRARY.search(frames[-1]["file"]):
        return False
    return re2.search(r"(?:^|[:;] *)(?:raise|assert)\b", frames[-1]["code"]) is not None


def _only_slips(mistake: Mistake) -> Mistake:
    def recognise(evidence: Evidence) -> Advice | None:
        return None if meant(traceback_of(evidence)) else mistake.recognise(evidence)

    return replace(mistake, recognise=recognise)


OTHER_SLIPS = tuple(map(_only_slips, OTHER_CRASHES))
"""Tracebacks that nobody meant; what a program raises on purpose is asked after what else is wrong with it."""
