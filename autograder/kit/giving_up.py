"""Clients whose server is late or missing: how long they wait, what they say meanwhile, and how they give up.

One rule holds for every client of the course. A client that ends and reports :data:`NOT_AVAILABLE` has given up well.
A client that repeatedly says that it waits may go on, with a remark about limits on the card. A function with a
parameter ``patience_sec`` must wait that long.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.model import Advice, Pace, mistake
from autograder.kit.outcomes import Outcome, all_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Bench, Mistake

PATIENCE = "patience_sec"
"""The parameter that tells a notebook's function how long to wait; also its name among a part's inputs."""
GIVE_UP_LIMIT = 12.0
"""Seconds within which a client without a server must have ended, or have said repeatedly that it waits."""
LATENESS = 1.5
"""Seconds by which a late server comes after its client."""
PATIENCES = (6.5, 6.95)
"""The range from which the seconds of patience are drawn.

A usual constant, such as 5 or 10, cannot pass as one of them, even with the tolerances below.
"""
PATIENCES_WITHOUT_A_SERVER = {Pace.FAST: (0.33, 0.37), Pace.REAL_TIME: PATIENCES}
"""The same range for a run without a server, in which the function waits for all of its patience.

A constant that is long enough for a late server is too long for these. A function that needs longer, such as one
that waits in whole seconds, gets the longer range in a second look.
the long one in a second look."""
TOO_LONG = 2.0
"""Seconds that a function may need in addition to its patience: to make its node, to remove it, to be slow."""
SLACK = 3.0
"""The tolerance as a multiple of a short patience; a slower function gets a longer patience in the second look."""
TOO_SHORT = 0.5
"""The smallest share of its patience that a function must wait."""
PART_OF_A_WAIT = 1.0
"""Seconds that a function may leave out at the end of a longer patience: it may wait in whole seconds."""
NOT_AVAILABLE = Outcome("not available")
"""The words that a client must report if its service or server is missing."""
WAITING = Outcome("not available", "waiting")
"""The words that a client which keeps waiting must say repeatedly."""
AGAIN_AND_AGAIN = 3
"""The number of times that a client must say that it waits."""
SAYS_SO_TO = 8.0
"""Seconds until which it must still say so: a client that says it every four seconds does, one that tried three
times does not.
"""
_CLIENTS = ("client", "action_client")
_AT_WORK = ("log", "called", "looked")
"""The kinds of events that show a working node, or a waiting function, even if the graph shows neither."""
MOMENT = 0.5
"""Seconds within which the same words count once: a log line arrives in two ways, and a loop may be fast."""


# --- time ----------------------------------------------------------------------------------------------------


def waited(part: Part) -> float:
    """Return the seconds from a subject's start to its end, or to the last event if it goes on."""
    start = part.first("subject", "started")
    end = part.ending or (part.events[-1] if part.events else None)
    return (end.t if end else 0.0) - (start.t if start else 0.0)


def patience(part: Part) -> float | None:
    """Return the seconds that the subject was told to wait; None if it has no parameter for that."""
    start = part.first("subject", "started")
    takes = start is not None and PATIENCE in start.data["accepted"]
    return float(part.inputs[PATIENCE]) if takes and PATIENCE in part.inputs else None


def drawn_patience(bench: Bench, between: tuple[float, float] = PATIENCES) -> float:
    """Draw the seconds that a function is told to wait, in whole hundredths."""
    return round(bench.random.uniform(*between), 2)


def await_it(bench: Bench) -> None:
    """Wait until a subject without a server has given up, or could have."""
    bench.await_end(GIVE_UP_LIMIT)


# --- without a server ----------------------------------------------------------------------------------------


def says_that_it_waits(part: Part) -> bool:
    """True if the subject says repeatedly that it waits, and not only at the beginning.

    The beginning is when its client was first seen: on a busy machine a program may need seconds until then.
    """
    looks = (event.t for event in part.of("interface") if any(map(event.data.get, _CLIENTS)))
    late = (next(looks, 0.0) + SAYS_SO_TO) / MOMENT
    times = _moments(part, WAITING)
    return len(times) >= AGAIN_AND_AGAIN and max(times) >= late


def _moments(part: Part, outcome: Outcome) -> set[int]:
    """Return the times at which a line with the word of an outcome came."""
    return {
        int(event.t / MOMENT)
        for event in part.events
        if any(map(outcome.is_said_in, replace(part, events=[event]).said()))
    }


def goes_on_waiting(part: Part) -> bool:
    """True if the subject waits for ever and may do so: it says so, and was not told how long to wait."""
    return bool(part.events) and part.ending is None and patience(part) is None and says_that_it_waits(part)


def waits_in_silence(part: Part) -> bool:
    """True if the client waits forever although the task forbids it."""
    return bool(part.events) and part.ending is None and not goes_on_waiting(part)


def served_otherwise(
    served: Sequence[Part], absent: Part, asked: Callable[[Part], bool], looks_elsewhere: bool
) -> list[Part]:
    """Return the runs in which the subject had its server, so that its words there do not report a missing one.

    In the first run the server comes late, so a client may once report it missing there, unless it never calls there.

    Args:
        served: The runs with a server; in the first one the server comes late.
        absent: The run without one.
        asked: Returns True if the subject sent the server a request in a run.
        looks_elsewhere: True if the subject looks for a server with another name.
    """
    late, *others = served
    found = [part for part in others if asked(part)]
    return [*found, late] if absent.events and not (asked(late) or looks_elsewhere) else found


def objection(part: Part, others: Sequence[Part] = (), role: str = "") -> str:
    """Return the fault of a client that finds no server, in words; empty if it behaves well.

    Args:
        part: The run without a server.
        others: Runs in which the subject had its server.
        role: The endpoint of a client that waits for its server, such as ``"client"``.
    """
    if not part.events:
        return "not reached"
    if part.ending is None:
        if role and not part.endpoints(role):
            return "looks for no server"
        return "" if goes_on_waiting(part) else f"still waiting after {GIVE_UP_LIMIT:g} s"
    if value := returned_answer(part):
        return f"returned {value}, as if that were the answer"
    return _unsaid(part, others) or broken_patience(part)


def _unsaid(part: Part, others: Sequence[Part]) -> str:
    # On a machine that shows the server slowly, a client may say once what it otherwise says repeatedly.
    times = _moments(part, NOT_AVAILABLE)
    said_again = bool(times) and max(times) - min(times) > 1
    return "" if said_again else NOT_AVAILABLE.missing(part, others)


def silent_end(part: Part, others: Sequence[Part], noun: str) -> Advice | None:
    """Return the diagnosis of a client that ends without a server and does not report it, or returns an answer anyway.

    Args:
        part: The run without a server.
        others: Runs in which the subject had its server.
        noun: The word for what is missing, such as ``"service"``.
    """
    if part.ending is None:
        return None
    if value := returned_answer(part):
        return Advice(
            f"When the {noun} is not there, your function returns {value}: its caller takes that for the answer.",
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


def returned_answer(part: Part) -> str:
    """Return the number or text that a function returned; empty if it returned nothing like an answer."""
    value = part.returned or ""
    is_answer = re2.fullmatch(r"-?\d+|['\"].*\pL.*", value) and not NOT_AVAILABLE.is_said_in(value)
    return value if is_answer else ""


def broken_patience(part: Part) -> str:
    """Return how the time of a function differs from its patience, in words; empty if it kept the patience."""
    limit = patience(part)
    if limit is None or part.ending is None:
        return ""
    if max(limit * TOO_SHORT, limit - PART_OF_A_WAIT) <= waited(part) <= limit + min(TOO_LONG, limit * SLACK):
        return ""
    return f"gave up after {waited(part):.1f} s, where {PATIENCE} was {limit:g}"


def looks_elsewhere(evidence: Evidence, absent: Part, role: str) -> bool:
    """True if a client that never called the server was seen to look for a server other than the task's.

    A client that ends, with or without a server, must have looked for another name. One that keeps waiting may have
    used the task's name with another type.

    Args:
        evidence: All runs of the client.
        absent: The run without a server.
        role: ``client`` or ``action_client``.
    """
    name, kind = evidence.reference.only(role)
    looked_for = [found for part in evidence for found in part.endpoints(role).items()]
    waits_on = absent.ending is None
    return any(other != name or (waits_on and its_type != kind) for other, its_type in looked_for)


def ended_at_once(part: Part) -> bool:
    """True if a function that was told how long to wait has ended much too early for any wait."""
    limit = patience(part)
    return limit is not None and part.ending is not None and waited(part) < limit * TOO_SHORT


def patience_not_kept(absent: str) -> Mistake:
    """Without a server, in the run named ``absent``, a function waits by a limit of its own."""
    return mistake(
        "patience_not_kept",
        lambda evidence: "" if _looked_for_nobody(evidence) else broken_patience(evidence.part(absent)),
        "When there is no server, your function {}.",
        f"Use {PATIENCE} as the limit, once: `if not your_client.wait_for_service(timeout_sec={PATIENCE}):` (or "
        f"`wait_for_server`), and below it say so and end: `raise TimeoutError(...)`. Without `raise` or `return` it "
        f"goes on to its next wait. A loop has to end {PATIENCE} seconds after it began.",
    )


def remark(absent: str) -> Callable[[Evidence], str]:
    """Return the card's remark on a client that keeps waiting without a server, in the run named ``absent``."""
    words = (
        "When there is no server, your client says again and again that it waits, and waits on. The task allows this; "
        "a robot that must not wait for ever needs a limit as well, such as a number of tries."
    )
    return lambda evidence: words if goes_on_waiting(evidence.part(absent)) else ""


# --- with a server -------------------------------------------------------------------------------------------


def gave_up(served: Sequence[Part], absent: Part, asked: Callable[[Part], bool]) -> bool:
    """True if the subject ended before it had found a server that was available.

    On the wire, a client that gave up looks like one that never meant to call: both just end. But the first says
    about an available server what it says about a missing one. The machine decides in which runs it ends too early: a
    client that looks only once may find the server in some runs, in all or in none.

    Args:
        served: The runs with a server; in the first one the server comes late.
        absent: The run without one.
        asked: Returns True if the subject sent the server a request in a run.
    """
    if _looked_for_nobody((absent, *served)):
        return False
    ended = [part for part in served if part.ending and not asked(part)]
    if served[0] in ended and any(asked(part) for part in served):
        return True
    told = set(all_lines(absent))
    alike = all(NOT_AVAILABLE.lines(part) or set(all_lines(part)) == told for part in ended)
    return bool(absent.ending and told and ended) and alike


def _looked_for_nobody(parts: Iterable[Part]) -> bool:
    """True if the subject ended well in each run, and was never seen as a node or to wait.

    A notebook's function may end before the graph shows its node; then its actions are unknown.
    """
    return all(
        part.ending is not None and part.ending.name in ("exited", "returned") and not _was_seen(part)
        for part in parts
    )


def _was_seen(part: Part) -> bool:
    return part.had_node or any(map(part.endpoints, _CLIENTS)) or any(map(part.of, _AT_WORK))


def not_forgotten(
    absent: str,
    noun: str,
    role: str,
    served: Callable[[Evidence], Sequence[Part]],
    asked: Callable[[Part], bool],
) -> Mistake:
    """A client gives up if its server is available, and not if it is absent: its condition lacks a ``not``.

    Args:
        absent: The name of the run without a server.
        noun: The word for what the client waits for, ``"service"`` or ``"server"``, as in the name of the wait.
        role: The client's endpoint, such as ``"client"``.
        served: Returns the runs with a server.
        asked: Returns True if the subject sent the server a request in a run.
    """
    wait = f"wait_for_{noun}"
    return mistake(
        "not_forgotten",
        lambda evidence: _gives_up_where_served(served(evidence), evidence.part(absent), role, asked),
        f"Your client says “{{}}” if the {noun} is there, and does not say it if there is none: the condition is "
        "the wrong way round.",
        f"{wait} returns True when the {noun} is there. Write `if not your_{role}.{wait}(timeout_sec=5.0):` above what "
        f"your client does without a {noun}.",
        certain=True,
    )


def _gives_up_where_served(
    served: Sequence[Part], absent: Part, role: str, asked: Callable[[Part], bool]
) -> str:
    """Return the line that reports a missing server in a run with a server, if no run without one has it."""
    if not (served and absent.events) or NOT_AVAILABLE.lines(absent):
        return ""
    if any(asked(part) or not (part.ending and part.endpoints(role)) for part in served):
        return ""
    told = [NOT_AVAILABLE.lines(part) for part in served]
    return told[0][-1] if all(told) else ""
