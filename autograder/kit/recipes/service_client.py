"""A service client: the judge serves, in each run in another way.

In one run the service comes late, in one it answers with a hidden bias, so that what the client reports shows whether
it used the answer, in one the numbers fill 64 bits, and in one there is no service. Among the answers are always a 0,
which is easily taken for none, and negative ones. In two runs one of the answers is held back for a while.

Which run is the one without a service nobody can tell from outside: after the run with the late service the others come
in an order that is drawn, and their numbers and their patience are of the same kinds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import re2

from autograder.kit import common_mistakes as common
from autograder.kit import giving_up, service_mistakes
from autograder.kit.crashes import OTHER_SLIPS
from autograder.kit.draft import OWN, OWN_LATE, Judge, Told
from autograder.kit.giving_up import drawn_patience
from autograder.kit.hangs import HANGS
from autograder.kit.lateness import (
    again_while,
    called_before_server,
    called_too_early,
    meets_late,
    meets_present,
    was_patient_with_an_answer,
)
from autograder.kit.model import Advice, Bench, Finding, Mistake, Pace
from autograder.kit.service_calls import (
    ABSENT,
    HANGS_AFTER,
    LATE,
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
from autograder.kit.texts_said import mentions

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from random import Random

    from autograder.kit.evidence import Evidence, Part

CALL_LIMIT = 15.0
"""Seconds of wall time in which a client that has its service must be done."""
AFTERMATH = 1.0
"""Seconds in which a client that has reported its sum may end, or go on and show what else it does."""
SAYS_MORE = {Pace.FAST: 2.0, Pace.REAL_TIME: 5.0}
"""Seconds in which a client that has said something of its last answer, and not the sum, may still say it."""
HELD = 0.7
"""Seconds for which an answer is held back: longer than anybody takes who does not really wait for it, and not as long
as a limit that programs are given, such as half a second."""


@dataclass(frozen=True)
class Run:
    """One run with a service.

    Attributes:
        name: The part's name.
        numbers: What the subject is to add.
        answers: What the service answers to one call after the other; to any further one, the sum.
        held: Which of the answers is held back, from 1 on; 0 for none.
    """

    name: str
    numbers: Sequence[int]
    answers: Sequence[int] = ()
    held: int = 0


def scenario(bench: Bench, runs: Sequence[Run], nobody: Sequence[int], *, calls: int) -> None:
    """All runs with a service, and one without.

    Args:
        bench: Where it happens.
        runs: The one with the late service first.
        nobody: What the subject is to add where there is no service.
        calls: How many calls a subject that has done its work has made.
    """
    late, *others = runs
    if not called(bench, late, calls) or called_before_server(bench.seen()):
        return
    known = bool(requests(bench.seen()))
    order: list[Run | None] = [*others, None]
    bench.random.shuffle(order)
    hangs = False
    for run in order:
        if run is None:
            unserved(bench, nobody)
        elif not hangs:
            hangs = not called(bench, run, calls, known=known)


def called(bench: Bench, run: Run, calls: int, *, known: bool = False) -> bool:
    """One run with a service; whether the subject came to an end of its work. One that is ``known`` has called it."""
    patience = drawn_patience(bench)
    bench.part(run.name, numbers=list(run.numbers), patience_sec=patience)
    meet = partial(meets_service, bench, run, calls, patience)
    if run.name != LATE:
        done = meets_present(bench, meet, "request", known=known, wanted=calls)
    else:
        done = meets_late(bench, lambda lateness: meet(lateness=lateness), "client", "request")

    def missed_an_answer(seen: Part) -> bool:
        return bool(run.held) and not reports(seen) and was_patient_with_an_answer(seen, ["request"])

    sooner = partial(meets_service, bench, replace(run, held=0), calls, patience)
    done = again_while(bench, missed_an_answer, sooner, done)
    bench.stop()
    return done


def meets_service(bench: Bench, run: Run, calls: int, patience: float, *, lateness: float = 0.0) -> bool:
    """Start the subject and serve it; whether it came to an end of its work.

    Args:
        bench: Where it happens.
        run: What is asked and answered.
        calls: How many calls a subject that has done its work has made.
        patience: Seconds that a function is told to wait.
        lateness: Seconds after its client at which the service comes.
    """
    service, type_name = bench.reference.only("client")
    bench.start(*run.numbers, patience_sec=patience)
    # The service comes when the judge has met its client. Where it was there before, the client may know it first, and
    # a call of one that ends at once would reach the judge or not, as it happens.
    # Where it has another client it waits for something else. One that has none may be slow to show it.
    if not bench.await_endpoint("client", service) and (
        bench.await_end(0.0) or bench.seen().endpoints("client")
    ):
        return bench.await_end(0.0)
    if lateness:
        bench.let_wait(lateness)
    server = bench.serve(service, type_name, answering(run.answers), hold=run.held)
    if run.held and bench.wait_until(
        lambda seen: len(requests(seen.main)) >= run.held, CALL_LIMIT, quiet=HANGS_AFTER
    ):
        # Any node on the graph may ask the client's node something meanwhile: that is not the answer.
        bench.settle()
        bench.await_end(HELD)
        server.release()
    done = bench.wait_until(lambda seen: has_spoken(seen, calls), CALL_LIMIT, quiet=HANGS_AFTER)
    if done and bench.wait_until(lambda seen: is_done(seen, calls), SAYS_MORE[bench.pace]):
        bench.await_end(AFTERMATH)
    else:
        bench.note_where_it_hangs()
    return done


def is_done(evidence: Evidence, calls: int) -> bool:
    """True if the subject has ended or, as a program may, has reported the sum and goes on spinning.

    Who is done stays so, also where one more call is on its way in that moment.
    """
    return evidence.main.ending is not None or has_reported(evidence.main, calls)


def has_spoken(evidence: Evidence, calls: int) -> bool:
    """True if the subject is done, or has at least said something of its last answer."""
    enough = evidence.main.of("response")[calls - 1 :]
    return is_done(evidence, calls) or (bool(enough) and bool(new_words(evidence.main, enough[0])))


def unserved(bench: Bench, numbers: Sequence[int]) -> None:
    """One run without the service."""
    if bench.keep(ABSENT):
        return
    patience = drawn_patience(bench, giving_up.PATIENCES_WITHOUT_A_SERVER[bench.pace])
    bench.part(ABSENT, numbers=list(numbers), patience_sec=patience)
    bench.start(*numbers, patience_sec=patience)
    service, _ = bench.reference.only("client")
    bench.await_endpoint("client", service)
    giving_up.await_it(bench)
    bench.stop()


def hidden(random: Random) -> int:
    """A number of so many that nobody can say them all."""
    return random.randint(10**9, 10**12)


def answering(scripted: Sequence[int]) -> Callable[[Mapping[str, Any]], Mapping[str, Any]]:
    """A service that gives these answers, one after the other, and after them the sum of the two numbers."""
    left = list(scripted)
    return lambda request: {"sum": left.pop(0) if left else _as_int64(request["a"] + request["b"])}


def _as_int64(number: int) -> int:
    # A client that adds in another order may leave the range; C++ servers wrap around, rclpy's would die of it.
    return (number + 2**63) % 2**64 - 2**63


class AnotherSum(NamedTuple):
    """What a client said of an answer, in place of its number.

    Attributes:
        answer: The number.
        line: The last line with another number.
    """

    answer: int
    line: str


class Calls:
    """The recipe for a client that has a service add numbers.

    Args:
        calls: How many calls a client that has done its work has made.
        runs: Draws the runs with a service: the late one, the surprising one, the one with large numbers.
        kinds: Each draws numbers of a kind that the runs have; those of the run without a service are of one of them.
        too_many: What one is told who calls ``{count}`` times, and what to do then.
        right: The numbers of each right call, from a run with as many calls as there should be.
    """

    roles = ("client",)

    def __init__(
        self,
        calls: int,
        runs: Callable[[Random], Sequence[Run]],
        kinds: Sequence[Callable[[Random], Sequence[int]]],
        *,
        too_many: tuple[str, str],
        right: Callable[[Part], Sequence[Sequence[int]]] = lambda part: [part.inputs["numbers"]],
    ) -> None:
        self._calls, self._runs, self._kinds, self._many = calls, runs, kinds, too_many
        self._right = right

    def scenario(self, bench: Bench) -> None:
        """Four runs: a late service, a surprising one, large numbers, and none at all."""
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
        """True if a run has as many calls as it should have, each with the right numbers."""
        made = requests(part)
        return len(made) == self._calls and list(map(pair, made)) == list(map(sorted, self._right(part)))

    def right_calls(self, wanted: str, *, given: str = " and ", asked: str = ", ") -> Judge[Client]:
        """A criterion: each run has the right calls.

        Args:
            wanted: What is expected, in words.
            given: What stands between the numbers that a run was given.
            asked: What stands between two calls.
        """

        def judge(seen: Client, _: Client) -> Finding:
            wrong = next((part for part in seen.served if not self.is_right(part)), None)
            if wrong is None:
                return Finding(True, wanted, wanted)
            if not wrong.events and (hung := cut_short(seen)):
                return Finding(False, wanted, hung)
            made = [f"{e.data['fields']['a']} + {e.data['fields']['b']}" for e in requests(wrong)[:3]]
            numbers = given.join(map(str, wrong.inputs.get("numbers", ())))
            return Finding(
                False, wanted, (f"for {numbers}: " if numbers else "") + (asked.join(made) or "no call")
            )

        return judge

    def waits(self, evidence: Evidence) -> Finding:
        """With a service that comes late it calls all the same; what comes of that is another criterion."""
        late = self.seen(evidence).late
        called = bool(requests(late))
        return Finding(called, "waits, then calls", "it did" if called else how_it_went(late))

    def unreported(self, says: str, next_step: str) -> Told[Client]:
        """Return a mistake: the calls are right, and the last answer is not said, or a string has its braces left."""

        def told(seen: Client, _: Client) -> Advice | None:
            part = self._unreported(seen)
            return (braces_left(part) or Advice(says, next_step)) if part else None

        return told

    def _unreported(self, seen: Client) -> Part | None:
        answered = (part for part in seen.served if part.of("response"))
        return next((part for part in answered if self.is_right(part) and not reports(part)), None)

    def another_sum(self, seen: Client) -> AnotherSum | None:
        """What is said in place of the last answer of a run with the right calls."""
        part = self._unreported(seen)
        if part is None:
            return None
        answer = answers(part)[-1]
        said = reversed(part.said(after=part.of("response")[-1]))
        line = next((line for line in said if re2.search(r"\d", line) and not mentions([line], answer)), None)
        return None if line is None else AnotherSum(answer, line)

    def _too_many_calls(self, evidence: Evidence) -> Advice | None:
        """More calls than the reference solution makes."""
        wanted = self.expected(evidence).calls
        counts = (len(requests(part)) for part in self.seen(evidence).served)
        many = next((count for count in counts if count > wanted), None)
        says, next_step = self._many
        return None if many is None else Advice(says.format(count=many), next_step)

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most telling first."""
        return (
            service_mistakes.WAITS_THE_WRONG_WAY_ROUND,
            *common.CRASHES,
            called_too_early("called the service", "wait_for_service"),
            common.endpoint_name("client"),
            common.message_type("client"),
            *OTHER_SLIPS,
            common.NOT_BEGUN,
            common.USAGE_MESSAGE,
            service_mistakes.WAITS_FOR_NOBODY,
            service_mistakes.WAITS_FOREVER,
            *(replace(hang, certain=True) for hang in (*HANGS, common.AWAITS_IN_VAIN)),
            service_mistakes.FIELDS_NEVER_FILLED,
            Mistake("too_many_calls", self._too_many_calls, certain=True),
            OWN,
            service_mistakes.ZERO_TAKEN_FOR_FAILURE,
            service_mistakes.NOT_RETURNED,
            service_mistakes.GAVE_UP_TOO_EARLY,
            service_mistakes.ANSWER_NOT_AWAITED,
            OWN_LATE,
            service_mistakes.SILENT_END,
            service_mistakes.PATIENCE_NOT_KEPT,
            *common.OTHER_CRASHES,
            *common.NOTHING_THERE,
        )
