"""A recipe for a client that lets a service add numbers. For its runs see :mod:`.service_runs`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.lateness import called_too_early
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import service_client_mistakes, unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, OTHER_SLIPS
from autograder.kit.mistakes.hangs import HANGS
from autograder.kit.model import Advice, Bench, Finding, Mistake, mistake
from autograder.kit.reading.service_calls import (
    WAIT,
    ClientSeen,
    answers,
    braces_left,
    cut_short,
    how_it_went,
    pair,
    reports,
    requests,
)
from autograder.kit.reading.texts_said import mentions
from autograder.kit.recipes.service_runs import scenario

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from random import Random

    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.recipes.service_runs import Run

_SUM_NOT_SAID = Advice(
    "The calls are right, but your program never prints the sum.",
    "Log or print the field `sum` of the service's last answer. In a notebook, also return the sum.",
)


class Calls:
    """The recipe for a client that lets a service add numbers.

    Args:
        calls: The number of calls of a client that has finished its work.
        runs: Draws the runs with a service: one with a late service, one with hidden numbers added, and one with large
            numbers.
        kinds: Functions that each draw numbers of one kind. One of them is chosen for the run without a service.
        wanted: The right calls in words, for the card.
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
        """Make four runs: a late service, hidden numbers in the answers, large numbers, and no service."""
        runs = self._runs(bench.random)
        nobody = bench.random.choice(self._kinds)(bench.random)
        scenario(bench, runs, nobody, calls=self._calls)

    def seen(self, evidence: Evidence) -> ClientSeen:
        """Return the subject's client, as the judge saw it."""
        return ClientSeen(evidence)

    def expected(self, evidence: Evidence) -> ClientSeen:
        """Return the client of the reference solution, as it was recorded."""
        return ClientSeen(evidence.reference)

    def is_right(self, part: Part) -> bool:
        """Return True if a run has the right number of calls, each with the right numbers."""
        made = requests(part)
        return len(made) == self._calls and list(map(pair, made)) == list(map(sorted, self._right(part)))

    def calls_right(self, evidence: Evidence) -> Finding:
        """Decide whether each run has the right calls."""
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
        """Return the number of calls in a run with more calls than the reference solution makes; 0 if there is none."""
        counts = (len(requests(part)) for part in self.seen(evidence).served)
        return next((count for count in counts if count > self.expected(evidence).calls), 0)

    def _wrong_numbers(self, evidence: Evidence) -> str:
        """Return in words the calls of a run with wrong numbers; empty if there is none.

        The text is also empty if a run has too few or too many calls, because that is another mistake.
        """
        found = self.calls_right(evidence)
        as_many = self.seen(evidence).called(self.expected(evidence).calls)
        return found.seen if as_many and not found.passed else ""

    def _no_call(self, evidence: Evidence) -> bool:
        """Return True if the subject has a client and ends by itself, but makes no call."""
        seen = self.seen(evidence)
        return seen.had_client and any(part.ending and not requests(part) for part in seen.served)

    def _unreported(self, evidence: Evidence) -> Part | None:
        """Return a run with the right calls whose last answer is not reported; None if there is none."""
        answered = (part for part in self.seen(evidence).served if part.of("response"))
        return next((part for part in answered if self.is_right(part) and not reports(part)), None)

    def _another_sum(self, evidence: Evidence) -> tuple[int, str] | None:
        """Return the last answer of an unreported run, and the last line with a different number; None if none."""
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
        """Yield the mistakes of a client with right calls that does not report the sum."""
        another = mistake(
            "wrong_sum_reported",
            self._another_sum,
            "The service's last answer was {0[0]}, but your program said “{0[1]}”.",
            "Report the field `sum` of the last answer unchanged, with all its digits. Do not report a sum that you "
            "computed yourself.",
        )
        for one in (another, Mistake("sum_not_reported", self._sum_not_said)):
            yield common.only_if_ended(one)
            yield one

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
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
                "Your client called the service {} times, but the task asks for fewer calls.",
                "Call the service once for each sum that you need, and wait for the answer.",
                certain=True,
            ),
            OWN,
            mistake(
                "wrong_arguments",
                self._wrong_numbers,
                f"A call has wrong numbers ({{}}); the task asks for {self._wanted}.",
                "Use the numbers that your code was given, with their minus signs. On a command line, they begin "
                "with sys.argv[1]; sys.argv[0] is the program's name. If you use the same request object twice, set "
                "both fields again.",
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
                "Make a request, set its fields a and b, and send it with call_async. Check whether a return or "
                "raise ends your function before the call. A sum that you compute yourself is not the server's "
                "answer.",
            ),
            *self._about_the_sum(),
            WAIT.silent_end(certain=True),
            WAIT.patience_not_kept(),
            *OTHER_CRASHES,
            *unfinished.NOTHING_THERE,
        )
