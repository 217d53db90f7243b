"""The runs of a service client: the judge is the server, and behaves differently in each run.

In one run, the service comes late. In another, it adds a hidden number to each sum, so that the client's report shows
whether the client used the answer. In a third, the numbers need 64 bits. In a fourth, there is no service. The answers
always include a 0, which is easily mistaken for a missing answer, and negative numbers. In two runs, one answer is held
back for a while.

In the first run, the service is only a little late. If the run without a service does not show that the client waits
long enough, or another run shows that it may go by a clock, the first run is made again with a service that comes as
late as the task allows.

The judge repeats a run only while a repetition can still save points. For example, a client of another type of service
is served in one run only.

In a class, a subject cannot predict which run has no service: after the run with the late service, the others come in
random order, with the same kinds of numbers and the same time limits. If a student waits for the card, the run without
a service comes first, because it is the shortest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from autograder.kit import giving_up
from autograder.kit.bench import Bench, Pace
from autograder.kit.giving_up import LATENESS, PATIENCE, drawn_patience, patience_without_a_server
from autograder.kit.lateness import (
    ANSWERS_LATE,
    ANSWERS_SOON,
    SOON,
    TRIES,
    again_while,
    called_before_server,
    hold_back,
    late_at_first,
    looks_for_it,
    may_be_impatient,
    meets_late,
    meets_present,
    second_lateness,
    was_patient_with_an_answer,
)
from autograder.kit.service_calls import (
    ABSENT,
    BIASED,
    EXTREME,
    HANGS_AFTER,
    LATE,
    has_reported,
    new_words,
    reports,
    requests,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from random import Random

    from autograder.kit.evidence import Evidence, Part

CALL_LIMIT = 15.0
"""Time limit in seconds of wall time for a client to finish once its service exists."""
AFTERMATH = 1.0
"""The number of seconds for which a client may go on after it has reported its sum, so that the judge sees what else it
does.
"""
SAYS_MORE = {Pace.FAST: 2.0, Pace.REAL_TIME: 5.0}
"""The time limit in seconds for reporting the sum, after the client has printed something else about its last answer.
"""


@dataclass(frozen=True)
class Run:
    """One run with a service.

    Attributes:
        name: The part's name.
        numbers: The numbers that the subject must add.
        answers: The answers to the first calls, in order. Any later call gets the right sum.
        held: The number of the answer, counted from 1, that is held back; 0 for none.
    """

    name: str
    numbers: Sequence[int]
    answers: Sequence[int] = ()
    held: int = 0


def scenario(bench: Bench, runs: Sequence[Run], numbers: Sequence[int], *, calls: int) -> None:
    """Make all runs with a service, and one without.

    Args:
        runs: The runs with a service; the one with the late service comes first.
        numbers: The numbers for the run without a service.
        calls: The number of calls of a subject that has finished its work.
    """
    late, *others = runs
    order: list[Run | None] = [*others, None]
    bench.random.shuffle(order)
    impatient = False
    if bench.is_waited_for:
        order.remove(None)
        impatient = _is_impatient(bench, numbers)
    _begin(bench, late)
    again = second_lateness([part for part in bench.before or () if part.name != LATE], "request")
    lateness = LATENESS if impatient else late_at_first(bench)
    if not called_late(bench, late, calls, lateness, again) or called_before_server(bench.seen()):
        bench.leave_out(ABSENT)
        return
    first = bench.seen()
    # A client of another type of service never reaches the judge's service.
    hangs = looks_for_it(bench, first, "client") is False
    served = [first]
    for run in order:
        if run is None:
            impatient = _is_impatient(bench, numbers)
        elif not hangs:
            _begin(bench, run)
            hangs = not called(bench, run, calls, served)
            served.append(bench.seen())
    again = second_lateness(served[1:], "request")
    clock = bench.pace is Pace.FAST and again > SOON
    if (impatient or clock) and lateness < LATENESS and requests(first):
        bench.again(LATE)
        called_late(bench, late, calls, LATENESS, again)


def _is_impatient(bench: Bench, numbers: Sequence[int]) -> bool:
    """Make the run without a service. Return True if the client may miss a service that comes as late as allowed."""
    unserved(bench, numbers)
    return may_be_impatient(bench)


def _begin(bench: Bench, run: Run) -> None:
    """Begin the part of a run with a service."""
    bench.part(run.name, numbers=list(run.numbers), patience_sec=drawn_patience(bench))


def called_late(bench: Bench, run: Run, calls: int, lateness: float, again: float) -> bool:
    """Make the run in which the service comes late. Return True if the subject finished its work."""
    done = meets_late(
        bench,
        lambda late: meets_service(bench, run, calls, lateness=late),
        "client",
        "request",
        lateness,
        again,
    )
    return _with_quick_answers(bench, run, calls, done)


def called(bench: Bench, run: Run, calls: int, earlier: Sequence[Part]) -> bool:
    """Make a run with a service that exists from the start.

    Args:
        run: The requests and answers.
        calls: The number of calls of a subject that has finished its work.
        earlier: The runs of this look, the one with the late service first.

    Returns:
        True if the subject finished its work.
    """
    first = earlier[0]
    # If a notebook's client has reported an answer, we know that it waits for answers. So from now on the service may
    # be there before the client starts: the client finds it at once, and no time is lost.
    prepared = bench.in_a_cell and reports(first)
    # A client that did not report an answer has lost the points for the sum, so the judge need not wait for a sum any
    # more.
    silent = [part for part in earlier if _is_silent(part, calls)]
    says_more = AFTERMATH if silent else SAYS_MORE[bench.pace]
    meet = partial(meets_service, bench, run, calls, prepared=prepared, says_more=says_more)
    done = meets_present(bench, meet, "request", known=bool(requests(first)), wanted=calls)
    # A client that also made too few calls has lost the points for its calls, too.
    lost = any(len(requests(part)) < calls for part in silent)
    return _with_quick_answers(bench, run, calls, done, 0 if lost else 1 if silent else TRIES)


def _is_silent(part: Part, calls: int) -> bool:
    """Return True if a client reported neither its last answer nor its answer number ``calls`` (from 1)."""
    return not reports(part) and not has_reported(part, calls)


def _with_quick_answers(bench: Bench, run: Run, calls: int, done: bool, tries: int = TRIES) -> bool:
    """End a run. If a patient client has missed an answer that was held back, first repeat the run without that delay.

    But in the fast look the run is not repeated, because the look in real time follows.
    """

    def missed_an_answer(seen: Part) -> bool:
        return bool(run.held) and not reports(seen) and was_patient_with_an_answer(seen, ["request"])

    sooner = partial(meets_service, bench, run, calls, held_for=ANSWERS_SOON)
    done = again_while(bench, missed_an_answer, sooner, done, tries if bench.pace is Pace.REAL_TIME else 0)
    bench.stop()
    return done


def meets_service(
    bench: Bench,
    run: Run,
    calls: int,
    *,
    lateness: float = 0.0,
    prepared: bool = False,
    says_more: float | None = None,
    held_for: float | None = None,
) -> bool:
    """Start the subject, and answer its calls. Return True if the subject finished its work.

    Args:
        run: The requests and answers.
        calls: The number of calls of a subject that has finished its work.
        lateness: The number of seconds by which the service starts after its client.
        prepared: True if the service starts before its client.
        says_more: The time limit in seconds for reporting the sum, after the client has printed something else about
            its last answer; by default :data:`SAYS_MORE`.
        held_for: The number of seconds from the request to its answer. By default, a first answer is held back as long
            as allowed even if a student waits, because only a long delay shows whether a client's time limit is long
            enough.
    """
    service, type_name = bench.reference.only("client")
    answer = answering(run.answers)
    server = bench.serve(service, type_name, answer, hold=run.held) if prepared else None
    bench.start(*run.numbers, patience_sec=bench.seen().inputs[PATIENCE])
    # Start the service only after the judge has discovered the client. If the client discovered the service first,
    # chance would decide whether the call of a client that ends at once reaches the judge. If the subject has ended or
    # has only clients for other services, end the run. If it has no client yet, start the service, because the subject
    # may only be slow.
    if not bench.await_endpoint("client", service) and (
        bench.await_end(0.0) or bench.seen().endpoints("client")
    ):
        return bench.await_end(0.0)
    if lateness:
        bench.let_wait(lateness)
    server = server or bench.serve(service, type_name, answer, hold=run.held)
    if run.held and bench.wait_until(
        lambda seen: len(requests(seen.main)) >= run.held, CALL_LIMIT, quiet=HANGS_AFTER
    ):
        # Before the answer, send the client's node an unrelated request. It exposes a client that handles one event and
        # takes this event for the answer.
        bench.settle()
        hold_back(
            bench, "request", run.held, ANSWERS_LATE if run.held == 1 and held_for is None else held_for
        )
        server.release()
    done = bench.wait_until(lambda seen: has_spoken(seen, calls), CALL_LIMIT, quiet=HANGS_AFTER)
    more = SAYS_MORE[bench.pace] if says_more is None else says_more
    if done and bench.wait_until(lambda seen: is_done(seen, calls), more):
        bench.await_end(AFTERMATH)
    else:
        bench.note_where_it_hangs()
    return done


def is_done(evidence: Evidence, calls: int) -> bool:
    """Return True if the subject has ended or has reported the sum.

    A program need not end, because it may keep spinning after its report. The result stays True even if the subject
    then sends one more call.
    """
    return evidence.main.ending is not None or has_reported(evidence.main, calls)


def has_spoken(evidence: Evidence, calls: int) -> bool:
    """Return True if the subject has finished, or has printed something after its last answer."""
    enough = evidence.main.of("response")[calls - 1 :]
    return is_done(evidence, calls) or (bool(enough) and bool(new_words(evidence.main, enough[0])))


def unserved(bench: Bench, numbers: Sequence[int]) -> None:
    """Make one run without the service."""
    if bench.keep(ABSENT):
        return
    patience = patience_without_a_server(bench, ABSENT)
    bench.part(ABSENT, numbers=list(numbers), patience_sec=patience)
    bench.start(*numbers, patience_sec=patience)
    service, _ = bench.reference.only("client")
    bench.await_endpoint("client", service)
    giving_up.await_it(bench)
    bench.stop()


def drawn_runs(random: Random, calls: int) -> tuple[Run, ...]:
    """Draw the runs with a service for a client that makes so many calls: a late one, a surprising one, and 64 bits.

    0 is an answer in two of them: as the last one where none of the numbers looks like it.
    """
    many = calls + 1
    return (
        Run(LATE, _everyday(random, many), (*[0] * (calls - 1), -hidden(random))),
        Run(BIASED, negative(random, many), (*(-hidden(random) for _ in range(calls - 1)), 0), calls - 1),
        # The last answer is held back: a client that does not wait for it must differ from one that takes 0 for none.
        Run(EXTREME, extreme(random, many), held=calls),
    )


def hidden(random: Random) -> int:
    """Return a random number from such a large range that a program cannot print all of its numbers."""
    return random.randint(10**9, 10**12)


def _everyday(random: Random, many: int) -> tuple[int, ...]:
    """Draw a number of everyday size, and zeros, because 0 is a number to be added, too."""
    return *random.sample((random.randint(1001, 99_999), 0), 2), *[0] * (many - 2)


def negative(random: Random, many: int) -> tuple[int, ...]:
    """Draw a negative number and larger positive ones."""
    return -random.randint(1001, 49_999), *(random.randint(50_001, 99_999) for _ in range(many - 1))


def extreme(random: Random, many: int) -> tuple[int, ...]:
    """Draw numbers near the ends of an int64 whose sums, one number after the other, stay inside it."""
    first = 2**62 - 1 - random.randint(0, 999), -(2**63) + random.randint(0, 999)
    return *first, *(-(2**62) // (many - 2) + random.randint(2001, 2999) for _ in range(many - 2))


def answering(scripted: Sequence[int]) -> Callable[[Mapping[str, Any]], Mapping[str, Any]]:
    """Return a function that answers requests: first with the given answers, then with the right sum."""
    left = list(scripted)
    return lambda request: {"sum": left.pop(0) if left else _as_int64(request["a"] + request["b"])}


def _as_int64(number: int) -> int:
    # A client that adds the numbers in another order may exceed 64 bits. C++ servers then wrap around, as this one
    # does; a server in rclpy would crash.
    return (number + 2**63) % 2**64 - 2**63
