"""How an action client reports the judge's goals, and what can be wrong with those reports."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.evidence import INTERRUPTED
from autograder.kit.giving_up import remark
from autograder.kit.mistakes.client_waits import Wait
from autograder.kit.model import Finding
from autograder.kit.outcomes import Outcome
from autograder.kit.reading.texts_said import mentions, said_first_after

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Evidence, Part

LATE = "the server comes late"
REFUSED = "the goal is refused"
ABORTED = "the goal is aborted"
ABSENT = "there is no server"
"""The name of the part without a server. In the first part of every exercise a goal is accepted."""
SERVED = (LATE, REFUSED, ABORTED)
"""The names of the parts in which the client should send a goal."""

WAIT = Wait("server", "action_client", "goal", ABSENT, SERVED)
"""The wait of a client that sends goals."""
FEEDBACKS = 14
"""The number of feedback messages for the goal that succeeds: enough to detect a client that stops receiving them."""
SUCCEEDED, CANCELED, WAS_ABORTED = Outcome("succeeded"), Outcome("canceled", "cancelled"), Outcome("aborted")
"""The three ways in which an accepted goal can end; a client reports each by this word or by the status number."""
REJECTED = Outcome("rejected")
NOT_ENDED = "said so, and did not end"
NO_GOAL = "no goal"
UNASKED = "a request to cancel the goal"
NOT_AWAITED = "it ended without taking in the answer to its goal"
MANY_REQUESTS = 3
"""The maximum number of times that a client may have a reason to request one result. A client that requests it more
often repeats without end.
"""

AT_ONCE = 3.6
"""Seconds: a client that ends sooner than this after an answer was sent never meant to use the answer.

A process takes a tenth of a second to end, and more than one second on a busy machine. A client that spins for 5
seconds, as many do, ends at least half a second later than this limit, even if its answer was held back; a client
that spins for 3 seconds ends a second earlier.
"""
STAYED = 1.5
"""Seconds: if the client still exists this long after a request, the request was not lost by the process ending."""
_WAYS = ("log", "output", "subject")
"""The kinds of events that contain words of the subject: logged to /rosout, printed, or returned."""
_TRACEBACK = "Traceback (most recent call last)"


def asked_for(part: Part) -> list[int]:
    """Return the ``order`` fields of the goals that the client sent, in order of time."""
    return [int(event.data["fields"]["order"]) for event in part.of("goal")]


def left_at_once(part: Part, answer: str = "goal_answered") -> bool:
    """Return True if the subject was already ending when the judge sent an answer that it had held back.

    The last requests of an ending process may or may not arrive, so no decision may depend on them. A printed
    traceback shows that a process is ending; a process that ends silently may take a while.
    """
    if part.ending is None:
        return False
    for event in part.events:
        if event.kind == answer:
            # A subject that fails only now has received something: the answer, or feedback sent after the answer.
            went_on = part.traceback or part.said(after=event) or _stayed_for_more(part, event)
            return not went_on and part.ending.t - event.t < AT_ONCE
        if event is part.ending or (event.kind == "output" and event.data["text"].startswith(_TRACEBACK)):
            return True
    return False


def _stayed_for_more(part: Part, answer: Event) -> bool:
    """Return True if the client still existed when its result was sent, or well after its request for the result."""
    assert part.ending is not None
    end, later = part.ending.t, part.events[part.events.index(answer) :]
    stayed = {"result": 0.0, "result_request": STAYED, "cancel": STAYED}
    return any(event.kind in stayed and end - event.t > stayed[event.kind] for event in later)


def goals_as_seen(evidence: Evidence) -> str:
    """Return in words what is wrong with the goals that the client sent."""
    if asked_for(evidence.part(LATE)) and left_at_once(evidence.part(LATE)):
        return NOT_AWAITED
    wanted = len(asked_for(evidence.reference.part(LATE)))
    parts = [evidence.part(name) for name in SERVED]
    for part in parts:
        orders = asked_for(part)
        if len(orders) > wanted:
            return f"{len(orders)} goals"
        if orders and orders[0] != part.inputs["order"]:
            return f"order {orders[0]} where {part.inputs['order']} was given"
        if part.name != REFUSED and cancels_unasked(part):
            return UNASKED
    missing = [part for part in parts if not asked_for(part)]
    if not missing or len(missing) == len(parts):
        return NO_GOAL if missing else ""
    tried = [part for part in missing if part.events]
    return (
        f"{NO_GOAL} where {tried[0].name}"
        if tried
        else f"{NO_GOAL} but the first: the other runs were left out"
    )


def cancels_unasked(part: Part) -> bool:
    """Return True if the client requests to cancel a running goal. After an interruption this is allowed."""
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
    """Return what the client said after the result was sent, without late copies of earlier lines."""
    return said_first_after(part.first("result"), part)


def reports_result(part: Part) -> bool:
    """Return True if the client said every number of the result, in the right order, after the result was sent."""
    result = part.first("result")
    if result is None or part.first("result_request") is None:
        return False
    numbers = [str(number) for number in _sequence(result)]
    # A log line is recorded twice: as output and on /rosout. One copy must not fill gaps of the other, so each kind
    # is searched alone.
    ways = ([event for event in part.events if event is result or event.kind == way] for way in _WAYS)
    return any(_are_in_order(numbers, replace(part, events=events).said(after=result)) for events in ways)


def _are_in_order(numbers: Sequence[str], lines: Sequence[str]) -> bool:
    # Only digits are compared, whatever the client prints between the numbers. The numbers are long and random, so the
    # other digits in the lines do not match them by chance.
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
    """Return a function's wrong return value in words; empty if the value is right, or if no function returned.

    Any sequence type counts as a list, for example a tuple or an array. A message object that contains a sequence
    does not.
    """
    if part.returned is None:
        return ""
    # The repr may also contain digits of the numbers' type, as in np.int32(5), or of a maximum length, as in
    # deque([5], maxlen=9).
    numbers = re2.findall(r"\d+", re2.sub(r"int\d+|maxlen=\d+", "", part.returned))
    right = numbers == [str(number) for number in wanted]
    return "" if right and _SEQUENCE.match(part.returned) else part.returned


def _waits(late: Part) -> bool:
    """Return True if the client waits for a late server and a late answer. If not, timing decides how far it gets."""
    return bool(asked_for(late)) and not left_at_once(late)


def refused_as_seen(evidence: Evidence) -> str:
    """Return in words what is wrong with the client's report of a refused goal; empty if nothing is."""
    part = evidence.part(REFUSED)
    goal = part.first("goal")
    if not part.events:
        return "not reached"
    if goal is None or not _waits(evidence.main):
        return NOT_AWAITED if goal else NO_GOAL
    if missing := REJECTED.missing(part, all_but(evidence, REFUSED)):
        return missing
    # A client that keeps running after a successful goal may also keep running here.
    return NOT_ENDED if part.ending is None and evidence.main.ending is not None else ""


def all_but(evidence: Evidence, name: str) -> list[Part]:
    """Return the other runs that have a goal; in each of them the goal ended differently."""
    return [part for part in evidence if part.name != name and part.first("goal")]


def aborted_as_seen(evidence: Evidence) -> str:
    """Return in words what is wrong with the client's report of an aborted goal.

    The status is also published on a topic, so a client may take it from there.
    """
    part = evidence.part(ABORTED)
    if not part.events:
        return "not reached"
    if part.first("result") is None or not _waits(evidence.part(LATE)):
        return NOT_AWAITED if part.first("goal") else NO_GOAL
    return WAS_ABORTED.missing(part, all_but(evidence, ABORTED))


# --- criteria -----------------------------------------------------------------------------------------------


def sends_the_goal(evidence: Evidence) -> Finding:
    """Decide whether the client sends one goal in each run, with the order that it was given."""
    wrong = goals_as_seen(evidence)
    expected = "one goal of the given order, in each run"
    return Finding(not wrong, expected, wrong or expected)


def shows_feedback(evidence: Evidence) -> Finding:
    """Decide whether the client logs or prints every feedback message."""
    part = evidence.part(LATE)
    sent, missing = part.of("feedback"), unshown_feedback(part)
    shown = len(sent) - len(missing)
    if sent and left_at_once(part, "result"):
        # How many messages arrive before the client ends depends on the machine's load, so the card gives no
        # number.
        return Finding(False, f"all {FEEDBACKS} feedback messages", "it ended before its goal did")
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
        return Finding(False, expected, "no goal to give a result for")
    asked = len(part.of("result_request"))
    if asked == 0:
        return Finding(False, expected, "never asked for the result")
    if asked > MANY_REQUESTS:
        return Finding(False, expected, f"asked for the result {asked} times")
    said = part.said(after=result)
    if returned := returned_instead(part, result.data["fields"]["sequence"]):
        return Finding(False, f"{result.data['fields']['sequence']} returned", f"returned {returned}")
    if not said and part.ending is not None and part.ending.t <= result.t:
        return Finding(False, expected, "it ended before the result came")
    return Finding(
        reports_result(part), expected, f"“{said[-1]}”" if said else "nothing was said after the result"
    )


def tells_of_refusal(evidence: Evidence) -> Finding:
    """Decide whether the client reports a refused goal, requests no result for it, and ends."""
    wrong = refused_as_seen(evidence)
    return Finding(not wrong, f"says {REJECTED} and ends", wrong or "it did")


def returns_nothing_of_a_refused_goal(evidence: Evidence) -> Finding:
    """Decide the same as :func:`tells_of_refusal`. A function that returns must also return an empty list."""
    told = tells_of_refusal(evidence)
    returned = returned_instead(evidence.part(REFUSED), [])
    if not told.passed or not returned:
        return told
    return Finding(False, "an empty list is returned for a goal that was rejected", f"returned {returned}")


def tells_of_abort(evidence: Evidence) -> Finding:
    """Decide whether the client reports an aborted goal, by the name or the number of the goal's status."""
    wrong = aborted_as_seen(evidence)
    return Finding(not wrong, f"says {WAS_ABORTED}, or `status` and 6", wrong or "it did")


def waits_for_the_server(evidence: Evidence) -> Finding:
    """Decide whether the client sends its goal even if the server comes late."""
    part = evidence.part(LATE)
    wrong = "" if asked_for(part) else "no goal came"
    if not wrong and left_at_once(part):
        wrong = NOT_AWAITED
    return Finding(not wrong, "waits, then sends its goal", wrong or "it did")


ends_without_a_server = WAIT.gives_up
"""Decide whether, without a server, the client reports that and ends, or repeatedly says that it waits."""
may_wait_on = remark(ABSENT)
"""Returns, for a client that keeps waiting without a server, the card's remark that a robot also needs a limit."""
