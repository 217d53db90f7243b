"""A client's patience: with a server that comes late, and with answers that take a moment.

On a quiet machine everything is there in milliseconds, and who hardly waits is as right as who does. So the judge
takes its time, as a server on a robot may: long enough to tell the two apart, and well below the few seconds that a
client has to allow for. Where a person waits beside a check cell, an answer takes less.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.giving_up import LATENESS
from autograder.kit.model import mistake

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.counterparts import ActionCounterpart
    from autograder.kit.evidence import Event, Evidence, Part
    from autograder.kit.model import Bench, Mistake

SOON = 0.3
"""Seconds that a server comes late after a client that has missed it by a moment."""
ANSWERS_LATE, ANSWERS_SOON = 0.7, 0.12
"""Seconds that an answer is held back; fewer where a person waits, and for a client that has just missed one. Neither
is a limit that programs are given, such as half a second."""
PATIENT_WITH_AN_ANSWER = 0.9
"""Seconds after which a client that has given up on an answer was patient: on a busy machine it may have missed it."""
PATIENT_WITH_A_RESULT = 4.0
"""The same for the result of a goal, whose feedback takes longer on a busy machine: between the 3 and the 5 seconds for
which many a client waits."""
TRIES = 3
"""The number of times that such a client is started again: a slow machine may miss what comes soon."""
PATIENT = 1.2
"""Seconds after which a client that has given up was patient: it may have missed the server by a moment."""


def answers_late(bench: Bench) -> float:
    """Seconds that an answer is held back."""
    return ANSWERS_SOON if bench.in_a_cell else ANSWERS_LATE


def called_before_server(part: Part) -> bool:
    """True if the last call was made before the server existed: ROS delivers such a request to no server.

    Only a notebook tells of its calls. The judge compares them with the start of its own server, so the answer is the
    same on a busy machine.
    """
    calls, serving = part.of("called"), part.first("serving")
    return bool(calls) and serving is not None and calls[-1].t < serving.t


def called_too_early(called: str, wait: str) -> Mistake:
    """The mistake of a client that calls without waiting for its server.

    Args:
        called: What the client did, in words.
        wait: The method that waits for the server.
    """

    def found(evidence: Evidence) -> bool:
        return any(map(called_before_server, evidence.parts))

    return mistake(
        "called_too_early",
        found,
        f"Your client {called} before the server was there. Such a request is lost: a server that starts later never "
        "gets it.",
        f"Wait for the server before you call: `if not your_client.{wait}(timeout_sec=5.0):` say so and end. "
        "Without its parentheses it waits for nothing.",
        certain=True,
    )


def was_patient(part: Part) -> bool:
    """True if a client that ended had waited for its server for :data:`PATIENT` seconds or longer."""
    return not called_before_server(part) and _waited_since(part, part.first("interface"), PATIENT)


def was_patient_with_an_answer(part: Part, requests: Sequence[str]) -> bool:
    """True if a client that ended had waited for the answer to its last request as long as anybody may ask.

    Args:
        part: What was seen of the client.
        requests: The kinds of the requests whose answers are held back.
    """
    request = next((event for event in reversed(part.events) if event.kind in requests), None)
    return _waited_since(part, request, PATIENT_WITH_AN_ANSWER)


def missed_a_result(part: Part) -> bool:
    """True if a client that ended before its goal did had waited for the result as long as anybody may ask."""
    result, ending = part.first("result"), part.ending
    missed = ending is not None and (result is None or ending.t <= result.t)
    return missed and _waited_since(part, part.first("result_request"), PATIENT_WITH_A_RESULT)


def _waited_since(part: Part, beginning: Event | None, seconds: float) -> bool:
    if beginning is None or part.ending is None:
        return False
    # A process may take its time to end; what it says of its end comes before that.
    last = next((event for event in reversed(part.events) if event.kind in ("output", "log")), part.ending)
    return last.t - beginning.t >= seconds


def await_goal(bench: Bench, server: ActionCounterpart, within: float) -> bool:
    """Wait for the subject's goal, and ask the subject's node something else while the answer is held back.

    Any node on the graph may do so: a client that takes the first event for the answer is right only by chance.

    Args:
        bench: Where it happens.
        server: The judge's server.
        within: Seconds that the goal may take.

    Returns:
        Whether the goal came and was answered.
    """
    came = bench.wait_until(lambda evidence: bool(evidence.main.of("goal")), within)
    if came:
        bench.settle()
    return server.await_goal(within if came else 0.0)


def hold_back(bench: Bench, kind: str) -> None:
    """Let time pass until the first event of a kind, a request, is as old as an answer that is held back.

    It takes longer while the machine is crowded: a subject that hardly waits needs time to say so.
    """
    seen = bench.seen()
    request = seen.first(kind)
    if request is not None:
        bench.await_end(max(0.0, answers_late(bench) - (seen.events[-1].t - request.t)))


def again_while(
    bench: Bench, missed: Callable[[Part], bool], meet: Callable[[], bool], done: bool, times: int = TRIES
) -> bool:
    """Start a subject again while it has missed something that it waited for.

    Args:
        bench: Where it happens.
        missed: Whether it has, by what was seen of its last run.
        meet: One more run; whether the subject came to an end of its work.
        done: Whether it did in the run before.
        times: How often at most.

    Returns:
        Whether it did in the last run.
    """
    for _ in range(times):
        if not done or not missed(bench.seen()):
            break
        bench.again()
        done = meet()
    return done


def _missed(request: str) -> Callable[[Part], bool]:
    """True if a patient client has sent its server no request of this kind."""
    return lambda seen: not seen.of(request) and was_patient(seen)


def meets_late(bench: Bench, meet: Callable[[float], bool], role: str, request: str) -> bool:
    """Have the subject meet a server that comes late; again, with less, where a patient one just missed it.

    What a client asks that dies in the same moment may be lost, too.

    Args:
        bench: Where it happens.
        meet: One run: how many seconds the server comes late. Whether the subject came to an end of its work.
        role: Of the subject's endpoint, such as ``client``.
        request: The kind of the event with which it asks the server.

    Returns:
        Whether it came to an end of its work in the last run.
    """

    def sooner() -> bool:
        return meet(SOON)

    done = again_while(bench, _missed(request), sooner, meet(LATENESS), 1)
    name, _ = bench.reference.only(role)
    # Who waits for another server would only wait once more.
    times = TRIES - 1 if name in bench.seen().endpoints(role) else 0
    return again_while(bench, _missed(request), sooner, done, times)


def meets_late_action(bench: Bench, meet: Callable[[float, float], bool], requests: Sequence[str]) -> bool:
    """Have the subject meet an action server that comes late; again, with less, where a patient one just missed it.

    Args:
        bench: Where it happens.
        meet: One run: how many seconds the server comes late, how many an answer is held back. Whether the subject
            came to an end of its work.
        requests: The kinds of the requests whose answers are held back.

    Returns:
        Whether it did in the last run.
    """
    held = answers_late(bench)
    done = meets_late(bench, lambda lateness: meet(lateness, held), "action_client", "goal")

    def missed_an_answer(seen: Part) -> bool:
        return not seen.of("result_request") and was_patient_with_an_answer(seen, requests)

    return again_while(bench, missed_an_answer, lambda: meet(SOON, ANSWERS_SOON), done)


def meets_present(
    bench: Bench, meet: Callable[[], bool], request: str, *, known: bool, wanted: int = 1
) -> bool:
    """Have the subject meet a server that is there; again where one that knows how to ask it ended without asking.

    What a client asks that ends in the same moment is lost now and then: it is started again once. On a very busy
    machine a client may take longer to hear of its server than it waits for it: a patient one is started again and
    again.

    Args:
        bench: Where it happens.
        meet: One run; whether the subject came to an end of its work.
        request: The kind of the event with which it asks the server.
        known: Whether it has asked a server in an earlier run. One that never asks is not started again.
        wanted: How many requests it is to send.

    Returns:
        Whether it came to an end of its work in the last run.
    """

    def asked_too_little(seen: Part) -> bool:
        return seen.ending is not None and len(seen.of(request)) < wanted

    done = again_while(bench, asked_too_little, meet, meet(), 1 if known else 0)
    return again_while(bench, _missed(request), meet, done, TRIES - 1 if known else 0)
