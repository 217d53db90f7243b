"""Criteria for action clients: how a client reports the goals that it sends, and what is wrong with a report."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.evidence import INTERRUPTED
from autograder.kit.giving_up import remark
from autograder.kit.mistakes.client_waits import Wait
from autograder.kit.mistakes.crashes import on_purpose, what_and_where
from autograder.kit.model import Finding, unless
from autograder.kit.outcomes import Outcome
from autograder.kit.reported_texts import mentions, said_first_after

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Evidence, Part


LATE = "the server comes late"
REFUSED = "the goal is refused"
ABORTED = "the goal is aborted"
ABSENT = "there is no server"
"""The name of the part in which no server exists. In the first part of every exercise, LATE, a goal is accepted."""
SERVED = (LATE, REFUSED, ABORTED)
"""The names of the parts in which the client should send a goal."""

WAIT = Wait("server", "action_client", "goal", ABSENT, SERVED)
"""The criterion and the mistakes of a client that waits for an action server."""
FEEDBACKS = 14
"""The number of feedback messages that the judge sends for the goal that succeeds. With fewer messages, a client that
stops receiving them would not be noticed.
"""
SUCCEEDED, CANCELED, WAS_ABORTED = Outcome("succeeded"), Outcome("canceled", "cancelled"), Outcome("aborted")
"""The three ways in which an accepted goal can end, each of which a client reports by the word or by the number of the
status.
"""
REJECTED = Outcome("rejected")
NOT_ENDED = "the rejection was reported, but the client did not end"
NO_GOAL = "no goal"
UNASKED = "a request to cancel the goal"
NOT_AWAITED = "the client ended without processing the answer to its goal"
MANY_REQUESTS = 3
"""The maximum number of requests for one result that a client may need. If a client makes more requests, it repeats
them without end.
"""

AT_ONCE = 3.6
"""A limit in seconds. A client that ends sooner than this after an answer was sent did not wait for the answer.

A process takes a tenth of a second to end, and more than one second on a busy machine. Many clients spin for 5 seconds;
they end at least half a second later than this limit, even if the judge held their answer back. A client that spins for
3 seconds ends one second earlier.
"""
STAYED = 1.5
"""A limit in seconds. If the client lives longer than this after it sent a request, its end cannot have lost the
request.
"""
_WAYS = ("log", "output", "subject")
"""The kinds of events that contain texts from the subject: logged to /rosout, printed, or returned."""
_TRACEBACK = "Traceback (most recent call last)"


def asked_for(part: Part) -> list[int]:
    """Return the ``order`` field of each goal that the client sent, in order of time."""
    return [int(event.data["fields"]["order"]) for event in part.of("goal")]


def left_at_once(part: Part, answer: str = "goal_answered") -> bool:
    """Return True if the subject was already ending when the judge sent the answer that the judge had held back.

    Then do not decide from the subject's last requests, because requests of an ending process may be lost. The subject
    was already ending if it had ended or printed a traceback before the answer, or if it ended soon after the answer
    without a reaction to it.
    """
    if part.ending is None:
        return False
    for event in part.events:
        if event.kind == answer:
            # A subject that prints something or fails only now has received the answer, or feedback sent after it.
            went_on = part.traceback or part.said(after=event) or _stayed_for_more(part, event)
            return not went_on and part.ending.t - event.t < AT_ONCE
        if event is part.ending or (event.kind == "output" and event.data["text"].startswith(_TRACEBACK)):
            return True
    return False


def _stayed_for_more(part: Part, answer: Event) -> bool:
    """Return True if the client lived until its result was sent, or for a while after a request.

    The request is for the result, or to cancel the goal.
    """
    assert part.ending is not None
    end, later = part.ending.t, part.events[part.events.index(answer) :]
    stayed = {"result": 0.0, "result_request": STAYED, "cancel": STAYED}
    return any(event.kind in stayed and end - event.t > stayed[event.kind] for event in later)


def goals_as_seen(evidence: Evidence) -> str:
    """Return in words what is wrong with the goals that the client sent; empty if nothing is wrong."""
    if asked_for(evidence.part(LATE)) and left_at_once(evidence.part(LATE)):
        return NOT_AWAITED
    wanted = len(asked_for(evidence.reference.part(LATE)))
    parts = [evidence.part(name) for name in SERVED]
    for part in parts:
        orders = asked_for(part)
        if len(orders) > wanted:
            return f"{len(orders)} goals"
        if orders and orders[0] != part.inputs["order"]:
            return f"order {orders[0]} although {part.inputs['order']} was given"
        if part.name != REFUSED and cancels_unasked(part):
            return UNASKED
    missing = [part for part in parts if not asked_for(part)]
    if not missing or len(missing) == len(parts):
        return NO_GOAL if missing else ""
    tried = [part for part in missing if part.events]
    return (
        f"{NO_GOAL} where {tried[0].name}"
        if tried
        else f"{NO_GOAL} after the first one: the other runs were left out"
    )


def cancels_unasked(part: Part) -> bool:
    """Return True if the client requests to cancel a running goal before the judge pressed Ctrl-C."""
    for event in part.events:
        if event.kind == "result" or event.name == INTERRUPTED:
            return False
        if event.kind == "cancel":
            return True
    return False


def unshown_feedback(part: Part) -> list[Event]:
    """Return the feedback messages whose last number the client neither printed nor returned after the message came.

    Each feedback message contains a list of numbers.
    """
    return [
        event for event in part.of("feedback") if not mentions(part.said(after=event), _sequence(event)[-1])
    ]


def _sequence(event: Event) -> list[int]:
    (numbers,) = event.data["fields"].values()
    return list(numbers)


def said_of_result(part: Part) -> list[str]:
    """Return the lines that the client printed, logged or returned after the result was sent, without late copies."""
    return said_first_after(part.first("result"), part)


def reports_result(part: Part) -> bool:
    """Return True if the client reported every number of the result in the right order, after the result was sent."""
    result = part.first("result")
    if result is None or part.first("result_request") is None:
        return False
    numbers = [str(number) for number in _sequence(result)]
    # A log line is recorded twice: as output and on /rosout. Search each kind of event alone, so that the numbers of
    # one copy are not added to those of the other.
    ways = ([event for event in part.events if event is result or event.kind == way] for way in _WAYS)
    return any(_are_in_order(numbers, replace(part, events=events).said(after=result)) for events in ways)


def _are_in_order(numbers: Sequence[str], lines: Sequence[str]) -> bool:
    # Only digits are compared, because a client may print anything between the numbers. Other digits in the lines do
    # not match by chance, because the numbers are long and random.
    digits, place = re2.sub(r"\D", "", " ".join(lines)), 0
    for number in numbers:
        place = digits.find(number, place)
        if place < 0:
            return False
        place += len(number)
    return True


_SEQUENCE = re2.compile(r"[\[(]|[a-z.]+\((?:'\w', )?[\[(]|[a-z.]+\((?:'\w')?\)")
"""Matches how the repr of a sequence begins: ``[1``, ``(1``, ``array('i', [1``, ``array('i')``, ``deque([1``."""


def returned_instead(part: Part, wanted: Sequence[int]) -> str:
    """Return the wrong value that a function returned, as its repr; empty if the value is right or nothing returned.

    A tuple, an array or any other sequence counts as a list, but a message object that contains a sequence does not.
    """
    if part.returned is None:
        return ""
    # The repr may also contain digits of the numbers' type, as in np.int32(5), or of a maximum length, as in
    # deque([5], maxlen=9).
    numbers = re2.findall(r"\d+", re2.sub(r"int\d+|maxlen=\d+", "", part.returned))
    right = numbers == [str(number) for number in wanted]
    return "" if right and _SEQUENCE.match(part.returned) else part.returned


def _waits(late: Part) -> bool:
    """Return True if the client waits for a late server and a late answer, so timing does not stop it halfway."""
    return bool(asked_for(late)) and not left_at_once(late)


def refused_as_seen(evidence: Evidence) -> str:
    """Return in words what is wrong with the client's report of a refused goal; empty if nothing is wrong."""
    part = evidence.part(REFUSED)
    goal = part.first("goal")
    if not part.events:
        return "not reached"
    if goal is None or not _waits(evidence.main):
        return NOT_AWAITED if goal else NO_GOAL
    if missing := REJECTED.missing(part, all_but(evidence, REFUSED)):
        return missing
    # A client that keeps running after a successful goal may also keep running after a refused one.
    return NOT_ENDED if part.ending is None and evidence.main.ending is not None else ""


def all_but(evidence: Evidence, name: str) -> list[Part]:
    """Return the runs with a goal, except the named run. In these other runs the goal ended in other ways."""
    return [part for part in evidence if part.name != name and part.first("goal")]


def aborted_as_seen(evidence: Evidence) -> str:
    """Return in words what is wrong with the client's report of an aborted goal; empty if nothing is wrong.

    A client that reads the status from the topic of statuses, and not from the result, is right, too.
    """
    part = evidence.part(ABORTED)
    if not part.events:
        return "not reached"
    if part.first("result") is None or not _waits(evidence.part(LATE)):
        return NOT_AWAITED if part.first("goal") else NO_GOAL
    return WAS_ABORTED.missing(part, all_but(evidence, ABORTED))


# --- criteria -----------------------------------------------------------------------------------------------


_ONE_GOAL = "one goal of the given order, in each run"
sends_the_goal = unless(_ONE_GOAL, goals_as_seen, _ONE_GOAL)
"""Decides whether the client sends one goal in each run, with the order that it was given."""


def shows_feedback(evidence: Evidence) -> Finding:
    """Decide whether the client logs or prints every feedback message."""
    part = evidence.part(LATE)
    sent, missing = part.of("feedback"), unshown_feedback(part)
    shown = len(sent) - len(missing)
    if sent and left_at_once(part, "result"):
        # The card gives no number, because the machine's load decides how many messages arrive before the client ends.
        return Finding(False, f"all {FEEDBACKS} feedback messages", "the client ended before its goal")
    return Finding(
        bool(sent) and not missing,
        f"all {FEEDBACKS} feedback messages",
        f"{shown} of them" if sent else "none was sent",
    )


def reports_the_result(evidence: Evidence) -> Finding:
    """Decide whether the client prints or returns the sequence of the result."""
    part = evidence.part(LATE)
    result = part.first("result")
    expected = f"{result.data['fields']['sequence']} said at the end" if result else "the result's sequence"
    if result is None:
        return Finding(False, expected, "the client sent no goal, so there was no result")
    asked = len(part.of("result_request"))
    if asked == 0:
        return Finding(False, expected, "the client never requested the result")
    if asked > MANY_REQUESTS:
        return Finding(False, expected, f"the client requested the result {asked} times")
    said = part.said(after=result)
    if returned := returned_instead(part, result.data["fields"]["sequence"]):
        return Finding(False, f"{result.data['fields']['sequence']} returned", f"returned {returned}")
    if not said and part.ending is not None and part.ending.t <= result.t:
        return Finding(False, expected, "the client ended before the result arrived")
    return Finding(
        reports_result(part), expected, f"“{said[-1]}”" if said else "nothing was reported after the result"
    )


tells_of_refusal = unless(f"says {REJECTED} and ends", refused_as_seen)
"""Decides whether the client reports a refused goal, and ends."""


def returns_nothing_of_a_refused_goal(evidence: Evidence) -> Finding:
    """Decide whether the client handles a refused goal well: a function returns an empty list, or raises on purpose."""
    told, part = tells_of_refusal(evidence), evidence.part(REFUSED)
    returned = returned_instead(part, [])
    crash = part.traceback and not on_purpose(part.traceback) and what_and_where(part.traceback)
    if not told.passed or not (returned or crash):
        return told
    expected = "an empty list is returned for a goal that was rejected"
    return Finding(False, expected, crash or f"returned {returned}")


tells_of_abort = unless(f"says {WAS_ABORTED}, or `status` and 6", aborted_as_seen)
"""Decides whether the client reports an aborted goal, by the name or the number of the goal's status."""


def _goal_missed(evidence: Evidence) -> str:
    part = evidence.part(LATE)
    if not asked_for(part):
        return "no goal came"
    return NOT_AWAITED if left_at_once(part) else ""


waits_for_the_server = unless("waits, then sends its goal", _goal_missed)
"""Decides whether the client sends its goal even if the server comes late."""


ends_without_a_server = WAIT.gives_up
"""Decides whether the client handles a missing server well: it reports this and ends, or repeatedly reports that it
waits.
"""
may_wait_on = remark(ABSENT)
"""Returns a remark for the card if the client keeps waiting without a server. It advises a time limit."""
