"""A service client: the judge is the server, and behaves differently in each run.

In one run the service comes late; in one it adds a hidden number to each sum, so that the client's report shows
whether it used the answer; in one the numbers fill 64 bits; and in one there is no service. The answers always
include a 0, which is easily mistaken for no answer, and negative numbers. In two runs one answer is held back for a
while.

The service is first only a little late. If the run without a service does not show that the client would have waited
for longer, the first run is made again with a service that comes as late as the task allows.

The judge repeats a run only while that can still save points, and serves a client of another type of service in one
run only.

The subject cannot tell in advance which run has no service: after the run with the late service, the others come in
random order, with the same kinds of numbers and the same time limits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit import giving_up
from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.giving_up import LATENESS, PATIENCE, drawn_patience, patience_without_a_server
from autograder.kit.lateness import (
    ANSWERS_LATE,
    ANSWERS_SOON,
    TRIES,
    again_while,
    called_before_server,
    called_too_early,
    hold_back,
    late_at_first,
    looks_for_it,
    may_be_impatient,
    meets_late,
    meets_present,
    was_patient_with_an_answer,
)
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import service_client_mistakes, unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, OTHER_SLIPS
from autograder.kit.mistakes.hangs import HANGS
from autograder.kit.model import Advice, Bench, Finding, Mistake, Pace, mistake
from autograder.kit.reading.service_calls import (
    ABSENT,
    HANGS_AFTER,
    LATE,
    WAIT,
    Client,
    answers,
    braces_left,
    cut_short,
    has_reported,
    how_it_went,
    new_words,
    pair,
    reports,
    requests,
)
from autograder.kit.reading.texts_said import mentions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from random import Random

    from autograder.kit.evidence import Evidence, Part

CALL_LIMIT = 15.0
"""Time limit in seconds of wall time for a client to finish once its service exists."""
AFTERMATH = 1.0
"""Seconds for which a client that has reported its sum may continue, so that the judge sees what else it does."""
SAYS_MORE = {Pace.FAST: 2.0, Pace.REAL_TIME: 5.0}
"""Time limit in seconds for the sum, once a client has said something else about its last answer."""


@dataclass(frozen=True)
class Run:
    """One run with a service.

    Attributes:
        name: The part's name.
        numbers: The numbers that the subject must add.
        answers: The service's answers to successive calls; to any further call it answers the sum.
        held: The number, from 1, of the answer that is held back; 0 for none.
    """

    name: str
    numbers: Sequence[int]
    answers: Sequence[int] = ()
    held: int = 0


def scenario(bench: Bench, runs: Sequence[Run], nobody: Sequence[int], *, calls: int) -> None:
    """All runs with a service, and one without.

    Args:
        bench: The bench of the scenario.
        runs: The runs with a service; the one with the late service comes first.
        nobody: The numbers in the run without a service.
        calls: The number of calls of a subject that has finished its work.
    """
    late, *others = runs
    begin(bench, late)
    if not called_late(bench, late, calls, late_at_first(bench)) or called_before_server(bench.seen()):
        return
    first = bench.seen()
    order: list[Run | None] = [*others, None]
    bench.random.shuffle(order)
    # A client of another type of service meets no service of the judge's.
    hangs = looks_for_it(bench, first, "client") is False
    served, impatient = [first], False
    for run in order:
        if run is None:
            unserved(bench, nobody)
            impatient = may_be_impatient(bench)
        elif not hangs:
            begin(bench, run)
            hangs = not called(bench, run, calls, served)
            served.append(bench.seen())
    if impatient and requests(first):
        bench.again(LATE)
        called_late(bench, late, calls, LATENESS)


def begin(bench: Bench, run: Run) -> None:
    """Begin the part of a run with a service."""
    bench.part(run.name, numbers=list(run.numbers), patience_sec=drawn_patience(bench))


def called_late(bench: Bench, run: Run, calls: int, lateness: float) -> bool:
    """Make the run in which the service comes late. Return True if the subject finished its work."""
    done = meets_late(
        bench, lambda late: meets_service(bench, run, calls, lateness=late), "client", "request", lateness
    )
    return _with_quick_answers(bench, run, calls, done)


def called(bench: Bench, run: Run, calls: int, earlier: Sequence[Part]) -> bool:
    """Make a run with a service that exists from the start.

    Args:
        bench: The bench of the scenario.
        run: The requests and answers.
        calls: The number of calls of a subject that has finished its work.
        earlier: The runs of this look, the one with the late service first.

    Returns:
        True if the subject finished its work.
    """
    first = earlier[0]
    # A client in the kernel that has reported an answer waits for answers, so its calls reach a service that existed
    # before it, too, and it need not look for the service a second time.
    prepared = bench.in_a_cell and reports(first)
    # A client that kept an answer to itself has lost the points for the sum: nothing waits for a sum any more.
    silent = [part for part in earlier if is_silent(part, calls)]
    says_more = AFTERMATH if silent else SAYS_MORE[bench.pace]
    meet = partial(meets_service, bench, run, calls, prepared=prepared, says_more=says_more)
    done = meets_present(bench, meet, "request", known=bool(requests(first)), wanted=calls)
    # If it also called too seldom, it has lost the points for its calls as well.
    lost = any(len(requests(part)) < calls for part in silent)
    return _with_quick_answers(bench, run, calls, done, 0 if lost else 1 if silent else TRIES)


def is_silent(part: Part, calls: int) -> bool:
    """Return True if a client reported neither its last answer nor that to its call number ``calls`` (from 1)."""
    return not reports(part) and not has_reported(part, calls)


def _with_quick_answers(bench: Bench, run: Run, calls: int, done: bool, tries: int = TRIES) -> bool:
    """End a run. If a patient client has missed an answer that was held back, first make the run again.

    In the fast look it is not made again, because the look in real time follows.
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
    """Start the subject and serve it. Return True if the subject finished its work.

    Args:
        bench: The bench of the scenario.
        run: The requests and answers.
        calls: The number of calls of a subject that has finished its work.
        lateness: Seconds by which the service comes after its client.
        prepared: True if the service comes before its client.
        says_more: Time limit in seconds for the sum, once the client has said something else about its last answer; by
            default :data:`SAYS_MORE`.
        held_for: Seconds for which the answer is held back, from its request on. By default, a first answer is held
            back as long as allowed even if a student waits, because only a long wait shows a client's limit.
    """
    service, type_name = bench.reference.only("client")
    answer = answering(run.answers)
    server = bench.serve(service, type_name, answer, hold=run.held) if prepared else None
    bench.start(*run.numbers, patience_sec=bench.seen().inputs[PATIENCE])
    # The service starts when the judge has discovered the client. If it existed before, the client might discover it
    # first, and chance would decide whether the call of a client that ends at once reaches the judge.
    # A subject with another client waits for something else. One without a client may only be slow to show it.
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
        # Meanwhile any node on the graph may send requests to the client's node, so an event is not necessarily the
        # answer.
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
    """True if the subject has ended or, as a program may, has reported the sum and keeps spinning.

    A subject that has finished stays finished, even if one more call is on its way.
    """
    return evidence.main.ending is not None or has_reported(evidence.main, calls)


def has_spoken(evidence: Evidence, calls: int) -> bool:
    """True if the subject has finished, or has at least said something about its last answer."""
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


def hidden(random: Random) -> int:
    """Return a number from a range that is so large that a program cannot print all of its numbers."""
    return random.randint(10**9, 10**12)


def answering(scripted: Sequence[int]) -> Callable[[Mapping[str, Any]], Mapping[str, Any]]:
    """Return a service that gives these answers in order, and after them the sum of the two numbers."""
    left = list(scripted)
    return lambda request: {"sum": left.pop(0) if left else _as_int64(request["a"] + request["b"])}


def _as_int64(number: int) -> int:
    # A client that adds in another order may exceed the range; C++ servers wrap around, rclpy's would crash.
    return (number + 2**63) % 2**64 - 2**63


_SUM_NOT_SAID = Advice(
    "The calls are right, but the sum is never said.",
    "Log or print the field sum of the last answer that the service gave. In a notebook, return it, too.",
)


class Calls:
    """The recipe for a client that has a service add numbers.

    Args:
        calls: The number of calls of a client that has finished its work.
        runs: Draws the runs with a service: the late one, the one with hidden changes, the one with large numbers.
        kinds: Each draws numbers of one kind; the run without a service uses one of these kinds, too.
        wanted: The right calls, in words.
        right: Returns the numbers of each right call of a run, if the run has the right number of calls.
    """

    roles = ("client",)

    def __init__(
        self,
        calls: int,
        runs: Callable[[Random], Sequence[Run]],
        kinds: Sequence[Callable[[Random], Sequence[int]]],
        *,
        wanted: str,
        right: Callable[[Part], Sequence[Sequence[int]]] = lambda part: [part.inputs["numbers"]],
    ) -> None:
        self._calls, self._runs, self._kinds = calls, runs, kinds
        self._wanted, self._right = wanted, right

    def scenario(self, bench: Bench) -> None:
        """Four runs: a late service, one with hidden changes, large numbers, and no service."""
        runs = self._runs(bench.random)
        nobody = bench.random.choice(self._kinds)(bench.random)
        scenario(bench, runs, nobody, calls=self._calls)

    def seen(self, evidence: Evidence) -> Client:
        """The subject, as it was seen."""
        return Client(evidence)

    def expected(self, evidence: Evidence) -> Client:
        """The reference solution, as it was recorded."""
        return Client(evidence.reference)

    def is_right(self, part: Part) -> bool:
        """True if a run has the right number of calls, each with the right numbers."""
        made = requests(part)
        return len(made) == self._calls and list(map(pair, made)) == list(map(sorted, self._right(part)))

    def calls_right(self, evidence: Evidence) -> Finding:
        """Each run has the right calls."""
        seen, wanted = self.seen(evidence), self._wanted
        wrong = next((part for part in seen.served if not self.is_right(part)), None)
        if wrong is None:
            return Finding(True, wanted, wanted)
        if not wrong.events and (hung := cut_short(seen)):
            return Finding(False, wanted, hung)
        made = [f"{e.data['fields']['a']} + {e.data['fields']['b']}" for e in requests(wrong)[:3]]
        numbers = ", ".join(map(str, wrong.inputs.get("numbers", ())))
        given = f"for {numbers}: " if numbers else ""
        return Finding(False, wanted, given + (", then ".join(made) or "no call"))

    def waits(self, evidence: Evidence) -> Finding:
        """Decide whether the client calls even if the service comes late; another criterion judges the result."""
        late = self.seen(evidence).late
        called = bool(requests(late))
        return Finding(called, "waits, then calls", "it did" if called else how_it_went(late))

    def _too_many_calls(self, evidence: Evidence) -> int:
        """Return the number of calls of a run with more than the reference solution makes."""
        counts = (len(requests(part)) for part in self.seen(evidence).served)
        return next((count for count in counts if count > self.expected(evidence).calls), 0)

    def _wrong_numbers(self, evidence: Evidence) -> str:
        """Return those calls with wrong numbers, up to the reference's number of calls."""
        found = self.calls_right(evidence)
        as_many = self.seen(evidence).called(self.expected(evidence).calls)
        return found.seen if as_many and not found.passed else ""

    def _no_call(self, evidence: Evidence) -> bool:
        """True if the subject ends by itself and has a client, but makes no call."""
        seen = self.seen(evidence)
        return seen.had_client and any(part.ending and not requests(part) for part in seen.served)

    def _unreported(self, evidence: Evidence) -> Part | None:
        """Return a run with the right calls, whose last answer is not reported."""
        answered = (part for part in self.seen(evidence).served if part.of("response"))
        return next((part for part in answered if self.is_right(part) and not reports(part)), None)

    def _another_sum(self, evidence: Evidence) -> tuple[int, str] | None:
        """Return the last answer of that run, and the last reported line that has a different number."""
        part = self._unreported(evidence)
        if part is None:
            return None
        answer = answers(part)[-1]
        said = reversed(part.said(after=part.of("response")[-1]))
        line = next((line for line in said if re2.search(r"\d", line) and not mentions([line], answer)), None)
        return None if line is None else (answer, line)

    def _sum_not_said(self, evidence: Evidence) -> Advice | None:
        part = self._unreported(evidence)
        return (braces_left(part) or _SUM_NOT_SAID) if part else None

    def _about_the_sum(self) -> Iterator[Mistake]:
        """Yield the mistakes of a client whose calls are right."""
        another = mistake(
            "wrong_sum_reported",
            self._another_sum,
            "The service's last answer was {0[0]}, but your program said “{0[1]}”.",
            "Report the field sum of the last answer as it is: all its digits, and no sum of your own.",
        )
        for one in (another, Mistake("sum_not_reported", self._sum_not_said)):
            yield common.only_if_ended(one)
            yield one

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, the most informative first."""
        return (
            WAIT.the_wrong_way_round(),
            *CRASHES,
            called_too_early("called the service", "wait_for_service"),
            common.endpoint_name("client"),
            common.message_type("client"),
            *OTHER_SLIPS,
            unfinished.NOT_BEGUN,
            unfinished.USAGE_MESSAGE,
            WAIT.for_nobody(),
            WAIT.for_ever(),
            *(replace(hang, certain=True) for hang in (*HANGS, common.AWAITS_IN_VAIN)),
            service_client_mistakes.FIELDS_NEVER_FILLED,
            mistake(
                "too_many_calls",
                self._too_many_calls,
                "Your client called the service {} times, which is more than the task asks for.",
                "Call once for each sum that you need, and wait for its answer.",
                certain=True,
            ),
            OWN,
            mistake(
                "wrong_arguments",
                self._wrong_numbers,
                f"The numbers of a call are wrong ({{}}); the task asks for {self._wanted}.",
                "Use the numbers that your code was given, with their minus signs, and none of your own: on a command "
                "line, sys.argv[0] is the program itself. If you use one request object twice, fill it anew.",
                certain=True,
            ),
            service_client_mistakes.ZERO_TAKEN_FOR_FAILURE,
            service_client_mistakes.NOT_RETURNED,
            WAIT.too_short(),
            service_client_mistakes.ANSWER_NOT_AWAITED,
            OWN_LATE,
            mistake(
                "no_call",
                self._no_call,
                "Your client never called the service.",
                "Make a request, fill a and b, and send it with call_async. Lines below a raise or a return, and "
                "indented like it, are never reached. What you add up yourself is not the answer of the server.",
            ),
            *self._about_the_sum(),
            WAIT.silent_end(certain=True),
            WAIT.patience_not_kept(),
            *OTHER_CRASHES,
            *unfinished.NOTHING_THERE,
        )
