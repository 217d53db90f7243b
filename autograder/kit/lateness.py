"""Decides whether a client is patient: whether it waits for a late server and for late answers.

On a quiet machine, everything is available in milliseconds, so a client that hardly waits would look as right as a
client that waits. Therefore the judge's servers and answers come late, as a real robot's may: late enough to show the
difference, but much sooner than after the few seconds for which a client must wait. If a student is waiting for a check
cell, the delays of answers are shorter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.bench import Pace
from autograder.kit.giving_up import CLOSELY, LATE_AT_FIRST, LATENESS, TOO_SHORT, patience, waited
from autograder.kit.model import mistake
from autograder.kit.service_calls import HANGS_AFTER

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.counterparts import ActionCounterpart
    from autograder.kit.evidence import Event, Evidence, Part
    from autograder.kit.model import Mistake

SOON = 0.3
"""Seconds after which the server starts in a repeated run, if the client ended shortly before its server was there."""
ANSWERS_LATE, ANSWERS_SOON = 0.7, 0.12
"""Two delays of an answer in seconds. The first one is usual. The second one is used if a student is waiting, or if the
client has just missed an answer.

Neither delay equals a common time limit of programs, such as half a second.
"""
PATIENT_WITH_AN_ANSWER = 0.9
"""A client that waited this many seconds for an answer before it gave up was patient, and may have missed the answer
only because the machine was busy.
"""
PATIENT_WITH_A_RESULT = 4.0
"""A client that waited this many seconds for a goal's result before it gave up was patient. The time is longer than for
an answer, because feedback takes longer on a busy machine. It is between the 3 and the 5 seconds that many clients
wait.
"""
TRIES = 3
"""The maximum number of times, in real time, that the judge starts a patient client again that has missed its server or
its answer, because a slow machine may miss even an early answer. In the fast look this number is 0, because the look in
real time is the next try.
"""
PATIENT = 1.2
"""A client that waited this many seconds for its server before it gave up was patient, and may have missed the server
only by a moment.
"""
HESITATION = 0.45
"""A client that waits for its server asks it sooner than after this many seconds: ``wait_for_service`` of rclpy looks
four times a second."""
LONG = 4.0
"""A client that waited this many seconds for its server has not missed it by a moment, so one more run is enough."""


def answers_late(bench: Bench) -> float:
    """Return the number of seconds for which the judge holds back an answer."""
    return ANSWERS_SOON if bench.in_a_cell else ANSWERS_LATE


def late_at_first(bench: Bench) -> float:
    """Return the delay of a server that comes late, in seconds.

    In the fast look the delay is short: only a run without a server shows how long the client would wait.
    """
    return LATE_AT_FIRST if bench.pace is Pace.FAST else LATENESS


def may_be_impatient(bench: Bench) -> bool:
    """Return True if the last run, which has no server, does not show that the client waits long enough.

    A function that was told how long to wait must wait for that time, any other client for a few seconds. A client that
    sends its request all the same has not waited. In real time the result is always False, because the server of the
    first run is as late as allowed in any case.
    """
    absent = bench.seen()
    limit = patience(absent)
    if bench.pace is Pace.REAL_TIME:
        return False
    if absent.ending is None:
        return bool(absent.of("called"))
    if limit is None:
        return not was_patient(absent)
    return not limit * TOO_SHORT <= waited(absent) <= limit + CLOSELY


def second_lateness(parts: Iterable[Part], request: str) -> float:
    """Return the server's delay in seconds in the second try of a client that has missed its late server.

    A client that let time pass before it asked a server that was available may go by a clock, and not wait at all. Then
    a sooner server would only suit its clock.

    Args:
        parts: The runs of the client in which its server was available.
        request: The event kind of the client's request to the server.
    """
    for part in parts:
        asked, *ready = map(part.first, (request, "serving", "interface"))
        if asked and asked.t - max((event.t for event in ready if event), default=asked.t) > HESITATION:
            return LATENESS
    return SOON


def called_before_server(part: Part) -> bool:
    """Return True if the client's last call was made before the server existed, so that no server received it.

    The result is False for programs, because only the calls of a notebook are recorded with their times. These are
    compared with the start of the judge's own server, so the result does not depend on the machine's load.
    """
    calls, serving = part.of("called"), part.first("serving")
    return bool(calls) and serving is not None and calls[-1].t < serving.t


def called_too_early(called: str, wait: str) -> Mistake:
    """Return the mistake of a client that calls without waiting for its server.

    Args:
        called: What the client did, in words; it completes a sentence that begins with "Your client".
        wait: The name of the method that waits for the server.
    """

    def found(evidence: Evidence) -> bool:
        return any(map(called_before_server, evidence.parts))

    return mistake(
        "called_too_early",
        found,
        f"Your client {called} before the server was available. Such a request is lost: a server that starts later "
        "never gets it.",
        f"Wait for the server before you call: write `if not your_client.{wait}(timeout_sec=5.0):`. Inside this "
        f"`if`, report that the server is not available, and end. Do not forget the parentheses after {wait}: "
        "without them the method is not called, and nothing waits.",
        certain=True,
    )


def was_patient(part: Part, seconds: float = PATIENT) -> bool:
    """Return True if a client that ended had waited this many seconds or longer for its server."""
    return not called_before_server(part) and _waited_since(part, part.first("interface"), seconds)


def was_patient_with_an_answer(part: Part, requests: Sequence[str]) -> bool:
    """Return True if a client that ended had waited long enough for the answer to its last request.

    Args:
        part: A run of the client.
        requests: The event kinds of the requests whose answers the judge holds back.
    """
    request = next((event for event in reversed(part.events) if event.kind in requests), None)
    return _waited_since(part, request, PATIENT_WITH_AN_ANSWER)


def stays_for_an_answer(part: Part, kind: str) -> bool:
    """Return True if a client that ended had waited for the answer to its last request.

    The time for which the client waited counts, and not whether the answer came before its end: on a busy machine and
    in real time, the judge holds an answer back for longer.

    Args:
        part: A run of the client.
        kind: The kind of event of its requests.
    """
    return _waited_since(part, next(reversed(part.of(kind)), None), ANSWERS_LATE)


def missed_a_result(part: Part) -> bool:
    """Return True if a client ended before its goal did, although it had waited long enough for the result."""
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
    """Wait for the subject's goal. While the answer is held back, send the subject's node an unrelated request.

    The request shows whether the client takes any first event for its answer. Such a client is right only by chance,
    because every node on the graph may send requests.

    Args:
        within: The time limit for the goal, in seconds; a client that falls silent gets less.

    Returns:
        True if the goal came and was answered.
    """
    came = bench.wait_until(lambda evidence: bool(evidence.main.of("goal")), within, quiet=HANGS_AFTER)
    if came:
        bench.settle()
    return server.await_goal(within if came else 0.0)


def hold_back(bench: Bench, kind: str, number: int = 1, seconds: float | None = None) -> None:
    """Wait until a request is as old as the delay of its answer.

    On a busy machine the wait is longer, because even a subject that hardly waits needs time to report something.

    Args:
        number: The number of the request among those of its kind, counted from 1.
        seconds: The time from the request to its answer; by default that of :func:`answers_late`.
    """
    seen = bench.seen()
    for request in seen.of(kind)[number - 1 : number]:
        age = seen.events[-1].t - request.t
        bench.await_end(max(0.0, (answers_late(bench) if seconds is None else seconds) - age))


def again_while(
    bench: Bench,
    missed: Callable[[Part], bool],
    meet: Callable[[], bool],
    done: bool,
    times: int | None = None,
) -> bool:
    """Start a subject again, up to ``times`` times, as long as its last run lacks something that a new run may show.

    Args:
        missed: Returns True if the record of a run lacks something, such as the request of a client that ended just
            before its server started.
        meet: Makes one more run. Returns True if the subject finished its work.
        done: True if the subject finished its work in the run that was made before this call.
        times: The maximum number of further runs; by default :data:`TRIES` in real time, and 0 in the fast look.

    Returns:
        True if the subject finished its work in the last run.
    """
    for _ in range(_tries(bench) if times is None else times):
        if not done or not missed(bench.seen()):
            break
        bench.again()
        done = meet()
    return done


def _tries(bench: Bench) -> int:
    """Return the maximum number of times that the judge starts a patient client again: 0 in the fast look."""
    return TRIES if bench.pace is Pace.REAL_TIME else 0


def _missed(request: str) -> Callable[[Part], bool]:
    """Return a function that decides whether a client never sent this request, although it waited for its server."""
    return lambda seen: not seen.of(request) and was_patient(seen)


def _missed_by_a_moment(request: str) -> Callable[[Part], bool]:
    """Like :func:`_missed`, but False for a client that waited :data:`LONG` seconds or longer."""
    return lambda seen: _missed(request)(seen) and not was_patient(seen, LONG)


def looks_for_it(bench: Bench, part: Part, role: str) -> bool | None:
    """Return True if the client looks for the exercise's server, False if for another server, None if for no server."""
    found = part.endpoints(role)
    if not found:
        return None
    name, type_name = bench.reference.only(role)
    return found.get(part.real_name(name)) == type_name


def meets_late(
    bench: Bench,
    meet: Callable[[float], bool],
    role: str,
    request: str,
    lateness: float = LATENESS,
    again: float = SOON,
) -> bool:
    """Run the subject with a late server. If a patient subject ends without a request, run the subject again.

    The server of the next run starts sooner, because the subject may have ended just before the late server started. Or
    the request was lost, because the subject ended right after it had sent the request.

    Args:
        meet: Makes one run with a server that is this many seconds late. Returns True if the subject finished its
            work.
        role: The role of the subject's endpoint, such as ``client``.
        request: The event kind of the subject's request to the server.
        lateness: The delay of the server in the first run, in seconds.
        again: The delay in a further run, as :func:`second_lateness` returns it.

    Returns:
        True if the subject finished its work in the last run.
    """

    def sooner() -> bool:
        return meet(again)

    def missed(seen: Part) -> bool:
        # If a client waits for another server, a further run would show the same.
        return looks_for_it(bench, seen, role) is not False and _missed(request)(seen)

    done = again_while(bench, missed, sooner, meet(lateness), 1)
    times = _tries(bench) - 1 if looks_for_it(bench, bench.seen(), role) else 0
    return again_while(bench, _missed_by_a_moment(request), sooner, done, times)


def meets_late_action(
    bench: Bench,
    meet: Callable[[float, float], bool],
    requests: Sequence[str],
    lateness: float = LATENESS,
    held: float | None = None,
    again: float = SOON,
) -> bool:
    """Run the subject with an action server that is late and that holds back its answers.

    A subject may wait only for a limited time, and end before the server starts or before an answer comes. Then run the
    subject again with shorter delays.

    Args:
        meet: Makes one run. Its arguments are the delays of the server and of an answer, in seconds. Returns True if
            the subject finished its work.
        requests: The event kinds of the requests whose answers the judge holds back.
        lateness: The delay of the server in the first run, in seconds.
        held: The delay of these answers in the first run, in seconds; by default, the value of :func:`answers_late`.
        again: The delay of the server in a further run, as :func:`second_lateness` returns it.

    Returns:
        True if the subject finished its work in the last run.
    """
    delay = answers_late(bench) if held is None else held
    done = meets_late(bench, lambda late: meet(late, delay), "action_client", "goal", lateness, again)

    def missed_an_answer(seen: Part) -> bool:
        return not seen.of("result_request") and was_patient_with_an_answer(seen, requests)

    return again_while(bench, missed_an_answer, lambda: meet(SOON, ANSWERS_SOON), done)


def meets_present(
    bench: Bench, meet: Callable[[], bool], request: str, *, known: bool, wanted: int = 1
) -> bool:
    """Run the subject with a server that is available. Repeat the run if the client ended without a call.

    A request that a client sends just before it ends is sometimes lost, so the client is started once more. On a very
    busy machine, a client may stop waiting before it discovers the server; a patient client is started several times.

    Args:
        meet: Makes one run; returns True if the subject finished its work.
        request: The event kind of the subject's request to the server.
        known: True if the subject called a server in an earlier run. If False, the subject is not started again.
        wanted: The number of requests that the subject should send.

    Returns:
        True if the subject finished its work in the last run.
    """

    def asked_too_little(seen: Part) -> bool:
        # A client that waited long enough for the answer to its last request did not lose a request by ending.
        waited = was_patient_with_an_answer(seen, [request])
        return seen.ending is not None and len(seen.of(request)) < wanted and not waited

    done = again_while(bench, asked_too_little, meet, meet(), 1 if known else 0)
    times = _tries(bench) - 1 if known else 0
    return again_while(bench, _missed_by_a_moment(request), meet, done, times)
