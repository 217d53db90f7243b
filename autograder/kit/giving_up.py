"""Decides how clients behave if their server is late or missing: how long they wait, and how they give up.

Every client of the course may choose between two ways: it may end and report :data:`NOT_AVAILABLE`, or it may go on
waiting and repeatedly report that it waits. In the second case, the card remarks that a robot also needs a time limit.
A function with a parameter ``patience_sec`` must wait that many seconds before it gives up.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.bench import Pace
from autograder.kit.model import Advice
from autograder.kit.outcomes import Outcome, all_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence, Part

PATIENCE = "patience_sec"
"""The name of the parameter that tells a notebook's function how long to wait, and of the same value in a part's
inputs.
"""
GIVE_UP_LIMIT = 12.0
"""The time limit in seconds for a client without a server. Until then it must have ended, or have repeatedly reported
that it waits.
"""
LATENESS = 1.5
"""The maximum delay in seconds between a client's start and the start of its late server."""
LATE_AT_FIRST = 0.65
"""A shorter delay than :data:`LATENESS`, in seconds, which is enough as long as a later run without a server can show
whether the client would have waited longer.
"""
CLOSELY = 0.5
"""The number of seconds by which a function may exceed a short patience and still counts as using this patience as its
limit.

Even so, a function with a constant limit is noticed: if the constant is three quarters of a second or more, the
function waits too long, and if it is shorter, the function misses a server that comes after :data:`LATE_AT_FIRST`.
"""
PATIENCES = (6.5, 6.95)
"""The range, in seconds, from which a function's patience is drawn at random.

No common constant, such as 5 or 10, is in this range, even with the tolerances below.
"""
PATIENCES_WITHOUT_A_SERVER = {Pace.FAST: (0.2, 0.24), Pace.REAL_TIME: PATIENCES}
"""Like :data:`PATIENCES`, but for a run without a server, by pace. In the first look the range is short, to expose a
function that waits for a constant time. rclpy's own waits then take 0.25 s. A function that does not keep to the short
range, for example because it waits in whole seconds, gets the long range in the second look.
"""
TOO_LONG = 2.0
"""The number of seconds by which a function may exceed its patience, to make and destroy its node and for a slow
machine.
"""
SLACK = 1.1
"""A patience below this value, in seconds, is short. For a short patience, this value replaces :data:`TOO_LONG`."""
TOO_SHORT = 0.5
"""The minimum fraction of its patience that a function must wait."""
PART_OF_A_WAIT = 1.0
"""The number of seconds by which a function may end before its patience is over, because it may wait in whole seconds.
"""
NOT_AVAILABLE = Outcome("not available")
"""The words that a client must report if its service or action server is missing."""
COUNTS = (
    "Another exception, or a line that contains `not available`, counts as well. A program without `patience_sec` ends "
    "within 12 seconds, or says every three that it is `waiting`."
)
"""Says on the card which ways to give up count (:attr:`autograder.kit.model.Exercise.counts`)."""
WAITING = Outcome("not available", "waiting")
"""The words that a client must repeat if it keeps waiting."""
AGAIN_AND_AGAIN = 3
"""The minimum number of times that a client must report that it is still waiting."""
SAYS_SO_TO = 8.0
"""A client counts as still waiting only if its last report that it waits comes at least this many seconds after the
judge first saw the client. A client that reports every four seconds gets there; one that stops after three tries does
not.
"""
_CLIENTS = ("client", "action_client")
_AT_WORK = ("log", "called", "looked")
"""The kinds of events that show that a node or function is running, even if the ROS graph does not show it."""
MOMENT = 0.5
"""Reports within this many seconds count only once, because a log line is recorded twice (printed and on /rosout), and
a loop may be fast.
"""


# --- time ----------------------------------------------------------------------------------------------------


def waited(part: Part) -> float:
    """Return the number of seconds from the subject's start to its end or, if it has not ended, to its last event."""
    start = part.first("subject", "started")
    end = part.ending or (part.events[-1] if part.events else None)
    return (end.t if end else 0.0) - (start.t if start else 0.0)


def patience(part: Part) -> float | None:
    """Return the number of seconds that the subject was told to wait; None if it has no parameter for this."""
    start = part.first("subject", "started")
    takes = start is not None and PATIENCE in start.data["accepted"]
    return float(part.inputs[PATIENCE]) if takes and PATIENCE in part.inputs else None


def drawn_patience(bench: Bench, between: tuple[float, float] = PATIENCES) -> float:
    """Draw the number of seconds that a function is told to wait, rounded to hundredths."""
    return round(bench.random.uniform(*between), 2)


def patience_without_a_server(bench: Bench, name: str) -> float:
    """Draw the number of seconds that a function is told to wait in the run without a server.

    In the second look, the time is long only if the function did not keep to a short one in the first look.
    """
    known = bench.before.part(name) if bench.before else None
    kept = known is not None and known.ending is not None and not broken_patience(known)
    return drawn_patience(bench, PATIENCES_WITHOUT_A_SERVER[Pace.FAST if kept else bench.pace])


def await_it(bench: Bench) -> None:
    """Wait until a subject without a server has given up, or has had enough time to do so."""
    bench.await_end(GIVE_UP_LIMIT)


# --- without a server ----------------------------------------------------------------------------------------


def _says_that_it_waits(part: Part) -> bool:
    """Return True if the subject repeatedly reports that it waits, and not only at its beginning.

    The beginning is the moment when the judge first saw the client, and not the start of the program, because on a busy
    machine a program may need seconds to make its client.
    """
    looks = (event.t for event in part.of("interface") if any(map(event.data.get, _CLIENTS)))
    late = (next(looks, 0.0) + SAYS_SO_TO) / MOMENT
    times = _moments(part, WAITING)
    return len(times) >= AGAIN_AND_AGAIN and max(times) >= late


def _moments(part: Part, outcome: Outcome) -> set[int]:
    """Return the times at which the subject reported an outcome, in units of :data:`MOMENT`."""
    return {
        int(event.t / MOMENT)
        for event in part.events
        if any(map(outcome.is_said_in, replace(part, events=[event]).said()))
    }


def goes_on_waiting(part: Part) -> bool:
    """Return True if the subject waits forever and may do so: it reports that it waits, and was given no patience."""
    return bool(part.events) and part.ending is None and patience(part) is None and _says_that_it_waits(part)


def waits_in_silence(part: Part) -> bool:
    """Return True if the client waits forever although the task forbids it."""
    return bool(part.events) and part.ending is None and not goes_on_waiting(part)


def objection(part: Part, others: Sequence[Part] = (), role: str = "") -> str:
    """Return in words what a client does wrong when it finds no server; empty if it behaves well.

    Args:
        part: The run without a server.
        others: Runs in which the subject had its server.
        role: The role of the endpoint that waits for the server, such as ``"client"``.
    """
    if not part.events:
        return "not reached"
    if part.ending is None:
        if role and not part.endpoints(role):
            return "looks for no server"
        return "" if goes_on_waiting(part) else f"still waiting after {GIVE_UP_LIMIT:g} s"
    if value := _returned_answer(part):
        return f"returned {value}, as if that were the answer"
    return _unsaid(part, others) or broken_patience(part)


def _unsaid(part: Part, others: Sequence[Part]) -> str:
    # A client that repeats the words in this run has reported the missing server. It may use the same words in a run
    # with a server, because discovery may be slow there.
    times = _moments(part, NOT_AVAILABLE)
    said_again = bool(times) and max(times) - min(times) > 1
    return "" if said_again else NOT_AVAILABLE.missing(part, others)


def silent_end(part: Part, others: Sequence[Part], noun: str) -> Advice | None:
    """Return the advice for a client that finds no server and says nothing about it, or returns an answer all the same.

    Args:
        part: The run without a server.
        others: Runs in which the subject had its server.
        noun: The word for the server, such as ``"service"``.
    """
    if part.ending is None:
        return None
    if value := _returned_answer(part):
        return Advice(
            f"If the {noun} is not available, your function returns {value}, which its caller takes for the answer.",
            "Raise TimeoutError instead, with a message that contains the words `not available`.",
        )
    if not _unsaid(part, others):
        return None
    return NOT_AVAILABLE.advice(
        part,
        others,
        f"There was no {noun}",
        f"Before your client ends, log an error such as “{noun} not available”, or raise a TimeoutError with these "
        "words.",
    )


def _returned_answer(part: Part) -> str:
    """Return the number or text that a function returned; empty if the value does not look like an answer."""
    value = part.returned or ""
    is_answer = re2.fullmatch(r"-?\d+|['\"].*\pL.*", value) and not NOT_AVAILABLE.is_said_in(value)
    return value if is_answer else ""


def broken_patience(part: Part) -> str:
    """Return in words how a function's wait differs from its patience; empty if it waited as long as it should."""
    limit = patience(part)
    if limit is None or part.ending is None:
        return ""
    slack = SLACK if limit < SLACK else TOO_LONG
    if max(limit * TOO_SHORT, limit - PART_OF_A_WAIT) <= waited(part) <= limit + slack:
        return ""
    return f"gave up after {waited(part):.1f} s, although {PATIENCE} was {limit:g}"


def ended_at_once(part: Part) -> bool:
    """Return True if a function that was told how long to wait ended so early that it cannot have waited."""
    limit = patience(part)
    return limit is not None and part.ending is not None and waited(part) < limit * TOO_SHORT


def remark(absent: str) -> Callable[[Evidence], str]:
    """Return a function that returns a remark for the card if the client keeps waiting without a server.

    ``absent`` is the name of the run without a server.
    """
    words = (
        "If there is no server, your client keeps waiting and reports this repeatedly. The task allows this. But a "
        "robot that must not wait forever needs a limit as well, such as a number of tries."
    )
    return lambda evidence: words if goes_on_waiting(evidence.part(absent)) else ""


# --- with a server -------------------------------------------------------------------------------------------


def gave_up(served: Sequence[Part], absent: Part, asked: Callable[[Part], bool]) -> bool:
    """Return True if the subject gave up: it reported a missing server and ended, although the server was available.

    On the network, a client that gave up looks like a client that never meant to call, because both just end. But a
    client that gave up prints the same words in a run with a server as in the run without one. All runs with a server
    are searched, because chance may decide in which of them a client ends too early.

    Args:
        served: The runs with a server. In the first one the server comes late.
        absent: The run without a server.
        asked: Decides whether the subject sent a request to the server in a run.
    """
    if looked_for_nobody((absent, *served)):
        return False
    ended = [part for part in served if part.ending and not asked(part)]
    if served[0] in ended and any(asked(part) for part in served):
        return True
    told = set(all_lines(absent))
    alike = all(NOT_AVAILABLE.lines(part) or set(all_lines(part)) == told for part in ended)
    return bool(absent.ending and told and ended) and alike


def looked_for_nobody(parts: Iterable[Part]) -> bool:
    """Return True if the subject ended in each run without an error, but never showed a node or a wait.

    This happens because a notebook's function may end before the graph shows its node. In that case it is unknown
    whether the function looked for a server.
    """
    return all(
        part.ending is not None
        and part.ending.name in ("exited", "returned")
        and not (part.had_node or any(map(part.endpoints, _CLIENTS)) or any(map(part.of, _AT_WORK)))
        for part in parts
    )
