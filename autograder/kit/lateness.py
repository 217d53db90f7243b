"""A client's patience: with a server that comes late, and with answers that take a moment.

On a quiet machine everything is available in milliseconds, so a client that hardly waits looks as right as one that
waits. So the judge is slow, as a server on a robot may be: slow enough to tell the two apart, and much faster than
the few seconds that a client must allow for. If a person waits for a check cell, answers come sooner.
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
"""Seconds by which a server comes late for a client that has just missed it."""
ANSWERS_LATE, ANSWERS_SOON = 0.7, 0.12
"""Seconds that an answer is held back; fewer if a person waits, and for a client that has just missed an answer.

Neither is a usual limit in programs, such as half a second.
"""
PATIENT_WITH_AN_ANSWER = 0.9
"""Seconds after which a client that gave up on an answer was patient: on a busy machine it may have missed the
answer.
"""
PATIENT_WITH_A_RESULT = 4.0
"""The same for the result of a goal, whose feedback takes longer on a busy machine: between the 3 and the 5 seconds
that many clients wait.
"""
TRIES = 3
"""The number of times that such a client is started again: a slow machine may miss even an early answer."""
PATIENT = 1.2
"""Seconds after which a client that gave up was patient: it may have missed the server by a moment."""


def answers_late(bench: Bench) -> float:
    """Return the seconds that an answer is held back."""
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
    """True if a client that ended had waited long enough for the answer to its last request.

    Args:
        part: What was seen of the client.
        requests: The event kinds of the requests whose answers are held back.
    """
    request = next((event for event in reversed(part.events) if event.kind in requests), None)
    return _waited_since(part, request, PATIENT_WITH_AN_ANSWER)


def missed_a_result(part: Part) -> bool:
    """True if a client that ended before its goal did had waited long enough for the result."""
    result, ending = part.first("result"), part.ending
    missed = ending is not None and (result is None or ending.t <= result.t)
    return missed and _waited_since(part, part.first("result_request"), PATIENT_WITH_A_RESULT)


def _waited_since(part: Part, beginning: Event | None, seconds: float) -> bool:
    if beginning is None or part.ending is None:
        return False
    # A process may need time to end, so its last output can come well before its end.
    last = next((event for event in reversed(part.events) if event.kind in ("output", "log")), part.ending)
    return last.t - beginning.t >= seconds


def await_goal(bench: Bench, server: ActionCounterpart, within: float) -> bool:
    """Wait for the subject's goal, and send the subject's node another request while the answer is held back.

    Any node on the graph may do so: a client that takes the first event for its answer is right only by chance.

    Args:
        bench: The bench of the scenario.
        server: The judge's server.
        within: The time limit for the goal, in seconds.

    Returns:
        True if the goal came and was answered.
    """
    came = bench.wait_until(lambda evidence: bool(evidence.main.of("goal")), within)
    if came:
        bench.settle()
    return server.await_goal(within if came else 0.0)


def hold_back(bench: Bench, kind: str) -> None:
    """Let time pass until the first event of a kind, a request, is as old as an answer that is held back.

    It takes longer on a busy machine: a subject that hardly waits needs time to report that.
    """
    seen = bench.seen()
    request = seen.first(kind)
    if request is not None:
        bench.await_end(max(0.0, answers_late(bench) - (seen.events[-1].t - request.t)))


def again_while(
    bench: Bench, missed: Callable[[Part], bool], meet: Callable[[], bool], done: bool, times: int = TRIES
) -> bool:
    """Start a subject again as long as it has just missed something that it waited for.

    Args:
        bench: The bench of the scenario.
        missed: Returns True if it has, from the record of its last run.
        meet: Makes one more run; returns True if the subject finished its work.
        done: True if it finished its work in the run before.
        times: The most runs to make.

    Returns:
        True if it finished its work in the last run.
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
    """Let the subject meet a late server; again, with shorter delays, if a patient subject just missed it.

    A request that a client sends in the moment in which it ends may be lost, too.

    Args:
        bench: The bench of the scenario.
        meet: Makes one run with a server this many seconds late; returns True if the subject finished its work.
        role: The role of the subject's endpoint, such as ``client``.
        request: The event kind of its request to the server.

    Returns:
        True if the subject finished its work in the last run.
    """

    def sooner() -> bool:
        return meet(SOON)

    done = again_while(bench, _missed(request), sooner, meet(LATENESS), 1)
    name, _ = bench.reference.only(role)
    # A client that waits for another server would only wait once more.
    times = TRIES - 1 if name in bench.seen().endpoints(role) else 0
    return again_while(bench, _missed(request), sooner, done, times)


def meets_late_action(bench: Bench, meet: Callable[[float, float], bool], requests: Sequence[str]) -> bool:
    """Let the subject meet a late action server; again, with shorter delays, if a patient subject just missed it.

    Args:
        bench: The bench of the scenario.
        meet: Makes one run, given the seconds by which the server is late and an answer is held back; returns True if
            the subject finished its work.
        requests: The event kinds of the requests whose answers are held back.

    Returns:
        True if the subject finished its work in the last run.
    """
    held = answers_late(bench)
    done = meets_late(bench, lambda lateness: meet(lateness, held), "action_client", "goal")

    def missed_an_answer(seen: Part) -> bool:
        return not seen.of("result_request") and was_patient_with_an_answer(seen, requests)

    return again_while(bench, missed_an_answer, lambda: meet(SOON, ANSWERS_SOON), done)


def meets_present(
    bench: Bench, meet: Callable[[], bool], request: str, *, known: bool, wanted: int = 1
) -> bool:
    """Let the subject meet an available server; again if a client that can call it ended without calling.

    A request that a client sends in the moment in which it ends is sometimes lost, so the client is started once
    more. On a very busy machine a client may wait for a shorter time than it needs to discover its server; a patient
    client is started several times.

    Args:
        bench: The bench of the scenario.
        meet: Makes one run; returns True if the subject finished its work.
        request: The event kind of its request to the server.
        known: True if the subject has called a server in an earlier run. One that never calls is not started again.
        wanted: The number of requests that it should send.

    Returns:
        True if the subject finished its work in the last run.
    """

    def asked_too_little(seen: Part) -> bool:
        return seen.ending is not None and len(seen.of(request)) < wanted

    done = again_while(bench, asked_too_little, meet, meet(), 1 if known else 0)
    return again_while(bench, _missed(request), meet, done, TRIES - 1 if known else 0)
