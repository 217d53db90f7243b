"""Clients whose server is late or does not come: how long they wait, what they say meanwhile, and how they give up.

One rule holds for every client of the course. A client that ends and reports :data:`NOT_AVAILABLE` has given up well.
A client that says again and again that it waits may go on, with a remark on the card about limits. A function that is
told how long to wait, by a parameter ``patience_sec``, keeps that time.
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
"""The parameter by which a notebook's function is told how long to wait; also its name among a part's inputs."""
GIVE_UP_LIMIT = 12.0
"""Seconds in which a client must have ended when nobody serves, or have said again and again that it waits."""
LATENESS = 1.5
"""Seconds that a late server comes after its client."""
PATIENCES = (6.5, 6.95)
"""Between which the seconds are drawn that a function is told to wait. No usual constant, such as 5 or 10, is taken for
one of these: it may differ from its patience by what is below."""
PATIENCES_WITHOUT_A_SERVER = {Pace.FAST: (0.33, 0.37), Pace.REAL_TIME: PATIENCES}
"""The same for a run without a server, in which all of the patience is waited. No constant that is long enough for a
late server is taken for the short one. A function that needs longer, as one that waits in whole seconds may, is told
the long one in a second look."""
TOO_LONG = 2.0
"""Seconds that a function may need on top of its patience: to make its node, to take it away, to be slow."""
SLACK = 3.0
"""The same as a multiple of a short patience; who was slower than that in a quick look is told a longer one."""
TOO_SHORT = 0.5
"""The share of its patience that a function must at least wait."""
PART_OF_A_WAIT = 1.0
"""Seconds that a function may leave out at the end of a longer patience: it may wait in whole seconds."""
NOT_AVAILABLE = Outcome("not available")
"""What a client has to say when its service or server is missing."""
WAITING = Outcome("not available", "waiting")
"""What one has to say again and again that goes on waiting."""
AGAIN_AND_AGAIN = 3
"""The number of times that a client says that it waits, to have said it again and again."""
SAYS_SO_TO = 8.0
"""Seconds after which it must still say so: who says it every four seconds does, and who tried three times does not."""
_CLIENTS = ("client", "action_client")
_AT_WORK = ("log", "called", "looked")
"""The kinds of events that show a node at work, or a function that waits, also where the graph tells of neither."""
MOMENT = 0.5
"""Seconds: what is said within these is said once. A log line comes on two ways, and a loop may be in a hurry."""


# --- time ----------------------------------------------------------------------------------------------------


def waited(part: Part) -> float:
    """Seconds from a subject's start to its end, or to the last event if it goes on."""
    start = part.first("subject", "started")
    end = part.ending or (part.events[-1] if part.events else None)
    return (end.t if end else 0.0) - (start.t if start else 0.0)


def patience(part: Part) -> float | None:
    """The seconds that the subject was told to wait; None where it has no parameter for that."""
    start = part.first("subject", "started")
    takes = start is not None and PATIENCE in start.data["accepted"]
    return float(part.inputs[PATIENCE]) if takes and PATIENCE in part.inputs else None


def drawn_patience(bench: Bench, between: tuple[float, float] = PATIENCES) -> float:
    """Seconds that a function is to be told to wait, in whole hundredths."""
    return round(bench.random.uniform(*between), 2)


def await_it(bench: Bench) -> None:
    """Wait until a subject without a server has given up, or could have."""
    bench.await_end(GIVE_UP_LIMIT)


# --- without a server ----------------------------------------------------------------------------------------


def says_that_it_waits(part: Part) -> bool:
    """True if the subject says that it waits again and again, and not only at the beginning.

    The beginning is where its client was seen: on a busy machine a program may need seconds to come so far.
    """
    looks = (event.t for event in part.of("interface") if any(map(event.data.get, _CLIENTS)))
    late = (next(looks, 0.0) + SAYS_SO_TO) / MOMENT
    times = _moments(part, WAITING)
    return len(times) >= AGAIN_AND_AGAIN and max(times) >= late


def _moments(part: Part, outcome: Outcome) -> set[int]:
    """The moments at which it said the word of an outcome."""
    return {
        int(event.t / MOMENT)
        for event in part.events
        if any(map(outcome.is_said_in, replace(part, events=[event]).said()))
    }


def goes_on_waiting(part: Part) -> bool:
    """True if the subject waits without end and may: it says so, and was not told how long to wait."""
    return bool(part.events) and part.ending is None and patience(part) is None and says_that_it_waits(part)


def waits_in_silence(part: Part) -> bool:
    """True if the subject waits without end and may not."""
    return bool(part.events) and part.ending is None and not goes_on_waiting(part)


def served_otherwise(
    served: Sequence[Part], absent: Part, asked: Callable[[Part], bool], looks_elsewhere: bool
) -> list[Part]:
    """The runs in which the subject had its server, so that what it says there is no report of a missing one.

    In the first run the server comes late, so a client may say once that it is missing, unless it never asks there.

    Args:
        served: The runs with a server; in the first one the server comes late.
        absent: The run without one.
        asked: Whether the subject asked the server for something in a run.
        looks_elsewhere: Whether it looks for a server of another name.
    """
    late, *others = served
    found = [part for part in others if asked(part)]
    return [*found, late] if absent.events and not (asked(late) or looks_elsewhere) else found


def objection(part: Part, others: Sequence[Part] = (), role: str = "") -> str:
    """The fault of a client that finds no server, in words; empty where it behaves well.

    Args:
        part: The run without a server.
        others: Runs in which it had its server.
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
    # What is said again and again may be said once where the machine is slow to show the server.
    times = _moments(part, NOT_AVAILABLE)
    said_again = bool(times) and max(times) - min(times) > 1
    return "" if said_again else NOT_AVAILABLE.missing(part, others)


def silent_end(part: Part, others: Sequence[Part], noun: str) -> Advice | None:
    """The diagnosis of a client that ends without a server and does not report it, or returns an answer all the same.

    Args:
        part: The run without a server.
        others: Runs in which it had its server.
        noun: What is missing, such as ``"service"``.
    """
    if part.ending is None:
        return None
    if value := returned_answer(part):
        return Advice(
            f"When the {noun} is not there, your function returns {value}: who calls it takes that for the answer.",
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
    """The number or text that a function returned; empty where it returned nothing that looks like an answer."""
    value = part.returned or ""
    is_answer = re2.fullmatch(r"-?\d+|['\"].*\pL.*", value) and not NOT_AVAILABLE.is_said_in(value)
    return value if is_answer else ""


def broken_patience(part: Part) -> str:
    """The difference between the time that a function took and its patience, in words; empty where it kept that."""
    limit = patience(part)
    if limit is None or part.ending is None:
        return ""
    if max(limit * TOO_SHORT, limit - PART_OF_A_WAIT) <= waited(part) <= limit + min(TOO_LONG, limit * SLACK):
        return ""
    return f"gave up after {waited(part):.1f} s, where {PATIENCE} was {limit:g}"


def looks_elsewhere(evidence: Evidence, absent: Part, role: str) -> bool:
    """True if a client that was never seen to ask for anything was seen to look for another server than the task's.

    One that ends, whether there is a server or not, must have looked under another name. One that goes on waiting may
    have had the task's name and another type.

    Args:
        evidence: All of its runs.
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
    """A function waits by a limit of its own in the run without a server, which is called ``absent``."""
    return mistake(
        "patience_not_kept",
        lambda evidence: "" if _looked_for_nobody(evidence) else broken_patience(evidence.part(absent)),
        "When there is no server, your function {}.",
        f"Use {PATIENCE} as the limit, once: `if not your_client.wait_for_service(timeout_sec={PATIENCE}):` (or "
        f"`wait_for_server`), and below it say so and end: `raise TimeoutError(...)`. Without `raise` or `return` it "
        f"goes on to its next wait. A loop has to end {PATIENCE} seconds after it began.",
    )


def remark(absent: str) -> Callable[[Evidence], str]:
    """The card's remark on a client that goes on waiting in the run without a server, which is called ``absent``."""
    words = (
        "When there is no server, your client says again and again that it waits, and waits on. The task allows this; "
        "a robot that must not wait for ever needs a limit as well, such as a number of tries."
    )
    return lambda evidence: words if goes_on_waiting(evidence.part(absent)) else ""


# --- with a server -------------------------------------------------------------------------------------------


def gave_up(served: Sequence[Part], absent: Part, asked: Callable[[Part], bool]) -> bool:
    """True if the subject ended before it had met a server that was there.

    On the wire a client that gave up and one that never meant to ask both only end. What tells them apart is that the
    first says of a server that is there what it says of one that is not. In which of the runs it ends too early depends
    on the machine: who looks once may find the server in some of them, in all or in none.

    Args:
        served: The runs with a server; in the first one the server comes late.
        absent: The run without one.
        asked: Whether the subject asked the server for something in a run.
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
    """True of a subject that came to a good end in each of its runs and was never seen to be a node, nor to wait.

    A notebook's function may be gone before the graph tells of its node, so what it did is not known then.
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
    """A client gives up where its server is there, and not where it is absent: its condition lacks a ``not``.

    Args:
        absent: The name of the run without a server.
        noun: What is waited for, ``"service"`` or ``"server"``, as in the name of the wait.
        role: The client's endpoint, such as ``"client"``.
        served: Gives the runs with a server.
        asked: Whether the subject asked the server for something in a run.
    """
    wait = f"wait_for_{noun}"
    return mistake(
        "not_forgotten",
        lambda evidence: _gives_up_where_served(served(evidence), evidence.part(absent), role, asked),
        f"Your client says “{{}}” where the {noun} is there, and does not say it where there is none: the condition is "
        "the wrong way round.",
        f"{wait} returns True when the {noun} is there. Write `if not your_{role}.{wait}(timeout_sec=5.0):` above what "
        f"your client does without a {noun}.",
        certain=True,
    )


def _gives_up_where_served(
    served: Sequence[Part], absent: Part, role: str, asked: Callable[[Part], bool]
) -> str:
    """The line by which a client reports a missing server where its server is there, and not where it is absent."""
    if not (served and absent.events) or NOT_AVAILABLE.lines(absent):
        return ""
    if any(asked(part) or not (part.ending and part.endpoints(role)) for part in served):
        return ""
    told = [NOT_AVAILABLE.lines(part) for part in served]
    return told[0][-1] if all(told) else ""
