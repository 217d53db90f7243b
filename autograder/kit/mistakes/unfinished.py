"""Mistakes of a subject that is not written yet, has no node, or ended before its work was finished."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit.giving_up import ended_at_once
from autograder.kit.mistakes.common_mistakes import WORDS, worked
from autograder.kit.mistakes.crashes import traceback_of
from autograder.kit.model import Advice, Mistake, card_words, filled_in, mistake
from autograder.kit.output.workspace_reports import report_of

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part

_WORDS = card_words(__file__)

STEP_MISSING = (
    "Find the TODO in your code and write that step. In a notebook, the hints are below the cell; each opens "
    "separately."
)
"""The advice if a step of the task is not written yet."""
_SPINS = "In main(), call rclpy.init(), make your node, and spin it with rclpy.spin(your_node)."
_CALLS = (
    "In main() of a client, call rclpy.init(), and then the function that sends the request or the goal and waits "
    "for the answer."
)
_BEGIN_AT_TODO = "If your code still has a TODO, write that step first."


def _what_main_does(evidence: Evidence) -> str:
    """Return in words what main() must do in this exercise: spin a node, make a request, or both."""
    roles = evidence.reference.interface.keys()
    clients = roles & {"client", "action_client"}
    spins = "" if roles and roles == clients else _SPINS
    calls = _CALLS if clients else ""
    return f"{spins} {calls}".strip()


def _main_guard(evidence: Evidence) -> Advice | None:
    ending = evidence.main.ending
    if ending is None or ending.name != "exited" or ending.data.get("code") != 0 or evidence.main.said():
        return None
    if evidence.main.had_node:
        return None
    at_once = "The program ended at once, without any output and without a node:"
    if report_of(evidence.main) is not None:  # The program is started by its entry point, which calls main().
        return Advice(f"{at_once} its main() makes no node.", f"{_what_main_does(evidence)} {_BEGIN_AT_TODO}")
    return filled_in(
        _WORDS["main_guard"], at_once=at_once, main=_what_main_does(evidence), todo=_BEGIN_AT_TODO
    )


_USAGE = re2.compile(r"(?i)\b(?:usage|uso|utilisation|aufruf|benutzung|verwendung|gebruik)\s*:")


def _usage_message(evidence: Evidence) -> str:
    """Return the line in which a program printed how to use it; empty if there is none, or if it sent a request."""
    if evidence.in_a_notebook:
        return ""
    told = [line for part in evidence for line in part.said() if _USAGE.search(line)]
    asked = any(part.of("request") or part.of("goal") for part in evidence)
    return told[0].strip() if told and not asked else ""


USAGE_MESSAGE = mistake("usage_message", _usage_message, *_WORDS["usage_message"], certain=True)


_WORK = ("message", "request", "answered", "goal", "goal_answer", "matched")
"""The kinds of events that show that a program works."""


def ended_too_early(evidence: Evidence) -> Advice | None:
    """Return advice if the subject ended by itself before its work was finished."""
    ending = evidence.main.ending
    if ending is None or traceback_of(evidence) or _main_guard(evidence):
        return None
    code = ending.data.get("code")
    exited = f"ended by itself, with exit code {code}," if code else "ended by itself"
    how = {"exited": exited, "returned": "returned"}.get(ending.name, "ended")
    keep = (
        "Keep the program running while it has work to do, for example with rclpy.spin(your_node). Put code that "
        "ends the program below the spin. Do not call exit() in a callback."
    )
    if not any(part.said() or any(map(part.of, _WORK)) for part in evidence):
        return Advice(
            f"The program {how} and did nothing that the judge could observe.", f"{_BEGIN_AT_TODO} {keep}"
        )
    roles = evidence.reference.interface.keys()
    if roles and roles <= {"client", "action_client"}:
        return None  # If a client did something, its end is not a mistake: the criteria say what is missing.
    asked = evidence.main.of("asked")
    is_open = len(asked) > len(evidence.main.of("answered"))
    when = (
        f"when {asked[-1].name} was called, and no answer came" if is_open else "before its work was finished"
    )
    return Advice(f"The program {how} {when}.", keep)


def _not_written(evidence: Evidence) -> str:
    """Return an endpoint that is missing although the code runs, such as "publishes on /chatter"; empty if none."""
    part = evidence.main
    if part.ending is not None and part.ending.name == "exited" and part.had_node:
        return ""  # A program may end before the ROS graph shows its endpoints.
    nodes = any(survey.data.get("nodes") for survey in part.of("interface"))
    returned_silently = part.returned is not None and not part.said()
    wanted = evidence.reference.interface
    missing = (
        f"{verb} {name}"
        for role, (verb, *_) in WORDS.items()
        for name in sorted(wanted.get(role, {}).keys() - part.endpoints(role))
    )
    return next(missing, "") if nodes or returned_silently else ""


def _returned_silently(evidence: Evidence) -> bool:
    """Return True if a function did nothing in any run: it returned, but printed, requested and published nothing."""
    asks = ("request", "goal", "message")
    return bool(evidence.main.events) and all(
        part.returned is not None and not part.said() and not any(map(part.of, asks)) for part in evidence
    )


def _returned_at_once(evidence: Evidence) -> bool:
    """Return True if a function did nothing in any run and returned at once, although it was told how long to wait."""
    asked = any(part.of("called") or part.of("looked") for part in evidence)
    return not asked and all(map(ended_at_once, evidence)) and _returned_silently(evidence)


def _without_node(evidence: Evidence) -> str:
    """Return the beginning of the sentence "No node of yours appeared on the graph."; empty if the subject had a node.

    If the subject has ended, the beginning says this, too.
    """
    if any(part.had_node or any(map(part.of, ("log", "request", "goal", "message"))) for part in evidence):
        return ""
    ending = evidence.main.ending
    ended = {"exited": "The program ended, and no", "returned": "Your function returned, and no"}
    return ended.get(ending.name, "No") if ending is not None else "No"


_CALM = 14.0
"""Seconds. On a machine that is not crowded, the judge stops waiting for a node earlier, after twelve seconds
(:data:`autograder.judge.bench.subject_presence.APPEAR`).
"""


def _surely_without_node(evidence: Evidence) -> str:
    """Return the text of :func:`_without_node`, but an empty text if the subject may have had a node.

    The node of a function that returned may have ended before the graph showed it. If the judge waited for long, the
    machine was crowded, and a program that still runs may not have come to the line that makes its node.
    """
    main = evidence.main
    waited = main.ending is None and any(survey.t > _CALM for survey in main.of("interface"))
    return "" if main.returned is not None or waited else _without_node(evidence)


def _never_constructed(part: Part) -> bool:
    """Return True if the constructor of a notebook's class never returned."""
    return part.first("subject", "never_constructed") is not None


def _works(part: Part) -> bool:
    return worked(part, "subscription")


NEVER_CONSTRUCTED = mistake(
    "never_ended",
    lambda evidence: any(_never_constructed(part) and not _works(part) for part in evidence),
    *_WORDS["never_ended"],
    certain=True,
)


def constructor_remark(evidence: Evidence) -> str:
    """Return a remark on a class that does its work in its constructor; empty for any other class."""
    if not any(_never_constructed(part) and _works(part) for part in evidence):
        return ""
    return (
        "Your node does its work inside its __init__, which never returns, so the line that makes the node never "
        "ends. In __init__, only make what the node needs, such as publishers and timers. Let callbacks do the work."
    )


NOT_BEGUN, _RETURNED_SILENTLY = (
    mistake(
        "not_written",
        found,
        "Your function returns at once without a value and calls no server: a step is not written yet.",
        STEP_MISSING,
        certain=True,
    )
    for found in (_returned_at_once, _returned_silently)
)
"""The mistakes of a function that is not written yet. NOT_BEGUN is checked before mistakes in how the function calls,
waits or gives up.
"""
NOTHING_THERE = (
    _RETURNED_SILENTLY,
    Mistake("main_guard", _main_guard, certain=True),
    *(
        mistake(
            "nothing_on_the_graph",
            found,
            *_WORDS["nothing_on_the_graph"],
            certain=found is _surely_without_node,
        )
        for found in (_surely_without_node, _without_node)
    ),
    mistake("not_written", _not_written, "Your code runs, but no node of yours {} yet.", STEP_MISSING),
    Mistake("ended_too_early", ended_too_early),
)
"""The mistakes that are checked last, if no more specific mistake is recognized."""
