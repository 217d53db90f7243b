"""Recognizes a method without a caller: its name is almost that of one that a class, a timer or the task calls."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

from autograder.kit.evidence import Event
from autograder.kit.model import Advice, Mistake

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Evidence
    from autograder.messages.judge_messages import OwnLine

UNCALLED = "uncalled"
"""The kind of the event that names such a method. It follows from the student's code, and no point depends on it."""
_DEF = "def "
_ALIKE = 0.75
"""How similar two names have to be, from 0 to 1, for one to be meant by the other."""


def uncalled(lines: Sequence[OwnLine], methods: Sequence[str]) -> list[Event]:
    """Return an event for each method of the student's code without a caller, whose name is almost a right one.

    Args:
        lines: The lines of the student's code by the names that they use.
        methods: The names of the methods that the solution defines, as far as the notebook shows them.
    """
    defined = {line.name.removeprefix(_DEF): line.place for line in lines if line.name.startswith(_DEF)}
    used = {line.name for line in lines}
    events = []
    for name, place in defined.items():
        there = {other for other, where in defined.items() if where == place}
        meant = difflib.get_close_matches(name, [*{*methods} - there], n=1, cutoff=_ALIKE)
        if meant and name not in used and name not in methods:
            events.append(Event(0.0, UNCALLED, name, {"meant": meant[0]}))
    return events


def _recognize(evidence: Evidence) -> Advice | None:
    for event in evidence.main.of(UNCALLED):
        return Advice(
            f"Your code has a method {event.name}, which is never called. The task calls it {event.data['meant']}.",
            f"Call it {event.data['meant']}, letter by letter: ROS or a base class calls it by this name.",
            uses=(f"{_DEF}{event.name}",),
        )
    return None


METHOD_UNCALLED = Mistake("method_uncalled", _recognize, certain=True)
