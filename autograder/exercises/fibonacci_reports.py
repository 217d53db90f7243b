"""What an action client has made of the judge's goals, and what is missing from it.

Any human language is right. So that a goal was refused or aborted counts as said where the client says something that
it does not say of a goal that succeeds, whatever the words are.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from autograder.exercises.service_clients import mentions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.exercises.evidence import Event, Evidence, Part

LATE = "the server comes late"
REFUSED = "the goal is refused"
ABORTED = "the goal is aborted"
ABSENT = "there is no server"
SERVED = (LATE, REFUSED, ABORTED)
"""The parts in which a goal is expected."""
GIVE_UP_LIMIT = 12.0
"""Seconds in which a client must have ended when there is no server; the task says 10."""

_SLIPS = ("AttributeError", "TypeError", "NameError", "UnboundLocalError", "KeyError", "IndexError")
"""Exceptions that nobody raises in order to say something."""


def asked_for(part: Part) -> list[int]:
    """The orders of the goals, in order."""
    return [int(event.data["fields"]["order"]) for event in part.of("goal")]


def goals_as_seen(evidence: Evidence) -> str:
    """What is wrong about the goals, in words."""
    wanted = len(asked_for(evidence.reference.part(LATE)))
    for part in map(evidence.part, SERVED):
        orders = asked_for(part)
        if len(orders) != wanted:
            return "no goal" if not orders else f"{len(orders)} goals"
        if orders[0] != part.inputs["order"]:
            return f"order {orders[0]} where {part.inputs['order']} was given"
    return ""


def unshown_feedback(part: Part) -> list[Event]:
    """The feedback messages whose newest number was not said after they were sent."""
    return [
        event for event in part.of("feedback") if not mentions(part.said(after=event), _sequence(event)[-1])
    ]


def _sequence(event: Event) -> list[int]:
    (numbers,) = event.data["fields"].values()
    return list(numbers)


def said_of_result(part: Part) -> list[str]:
    """What was said after the result was sent, without what is only a late echo of something said before.

    A log line comes twice, as output and on /rosout, and the second of the two may be slow.
    """
    result = part.first("result")
    if result is None:
        return []
    later = part.said(after=result)
    everything = part.said()
    before = everything[: len(everything) - len(later)]
    return [line for line in later if line not in before]


def reports_result(part: Part) -> bool:
    """Every number of the result was said after it was sent."""
    result = part.first("result")
    if result is None or part.first("result_request") is None:
        return False
    said = part.said(after=result)
    return all(mentions(said, number) for number in _sequence(result))


def shape(line: str) -> str:
    """A line without its numbers, so that two lines for two goals can be compared."""
    return re.sub(r"\d+", "#", line).strip()


def _new_words(evidence: Evidence, lines: Sequence[str]) -> list[str]:
    """Those of the lines that were not said, with other numbers, of the goal that succeeded."""
    usual = {shape(line) for line in evidence.part(LATE).said()}
    return [line for line in lines if shape(line) not in usual]


def raised_on_purpose(part: Part) -> bool:
    """Whether it ended with an exception that says something."""
    lines = [line for line in part.traceback.splitlines() if line.strip()]
    return bool(lines) and not lines[-1].startswith(_SLIPS)


def refused_as_seen(evidence: Evidence) -> str:
    """What is wrong about how a refused goal is told, in words."""
    part = evidence.part(REFUSED)
    goal = part.first("goal")
    if goal is None:
        return "no goal"
    if part.first("result_request") is not None:
        return "asked for the result of a goal that was refused"
    if not (_new_words(evidence, part.said(after=goal)) or raised_on_purpose(part)):
        return "nothing was said of it"
    # A client that goes on after a success, too, may go on here.
    if part.ending is None and evidence.part(LATE).ending is not None:
        return "said so, and did not end"
    return ""


def aborted_as_seen(evidence: Evidence) -> str:
    """What is wrong about how an aborted goal is told, in words."""
    part = evidence.part(ABORTED)
    result = part.first("result")
    if result is None:
        return "no goal" if part.events else "not reached"
    if part.first("result_request") is None:
        return "never asked for the result"
    said = said_of_result(part)
    if raised_on_purpose(part) or any(_names_aborted(line) for line in said):
        return ""
    new = [line for line in _new_words(evidence, said) if not _names_canceled(line)]
    if new:
        return ""
    return f"“{said[-1]}”" if said else "nothing was said after the result"


def _names_aborted(line: str) -> bool:
    plain = re.sub(r"\[[^\]]*\]|\([\d, ]*\)", "", line)
    return re.search(r"abort|(?<![\d.])6(?![\d.])", plain, re.IGNORECASE) is not None


def _names_canceled(line: str) -> bool:
    return re.search(r"cancel|succe|erfolg", line, re.IGNORECASE) is not None and "not" not in line.lower()


def given_up(evidence: Evidence) -> str:
    """What is wrong about how it gave up without a server, in words."""
    part = evidence.part(ABSENT)
    if not part.events:
        return "not reached"
    if part.ending is None:
        return f"still waiting after {GIVE_UP_LIMIT:g} s"
    # Who ends at once whether there is a server or not has not given up. But one that looks under another name has.
    named = {name for p in evidence for name in p.endpoints("action_client")}
    if not (any(map(asked_for, evidence)) or named - {evidence.reference.only("action_client")[0]}):
        return "never sent a goal to anybody"
    if not (part.said() or part.traceback or part.ending.name == "raised"):
        return "ended without a word"
    return ""
