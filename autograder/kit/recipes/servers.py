"""The recipe for a service server: the judge calls it one by one and at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from autograder.kit.bench import Bench, Pace
from autograder.kit.draft import OWN
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes.role_mistakes import ladder
from autograder.kit.model import Finding, Mistake
from autograder.kit.recipes.own_scenario import meet

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.counterparts import Caller
    from autograder.kit.evidence import Event, Evidence, Part


CALLS = "calls"
CALLS_AT_ONCE = 6
"""The number of simultaneous calls. It is less than 10, because the queue of a service holds 10 requests: with 12
calls, even a right server lost some (measured).
"""
QUIET = {Pace.FAST: 2.0, Pace.REAL_TIME: 6.0}
"""The seconds without any event after which the judge no longer waits for an answer, for each pace."""
LIVES_ON = (2.0, 3.0)
"""The range of the seconds of the server's time that pass before the last call, in which its timers may end it."""

Fields = Mapping[str, Any]
"""The fields of a request or of a response, by name."""
Objection = Callable[[Fields, Fields], str]
"""A function of a request and its answer that returns in words what is wrong; empty if nothing is."""


@dataclass(frozen=True)
class ServerSeen:
    """A server and the calls that the judge made to it.

    Attributes:
        part: The run in which the judge called the server.
        calls: The number of calls that the judge makes if each one is answered.
    """

    part: Part
    calls: int

    @property
    def asked(self) -> list[Event]:
        """All calls that were made, in order of time."""
        return self.part.of("asked")

    @property
    def singly(self) -> list[Event]:
        """The calls that were sent one at a time, each after the answer to the call before."""
        return self.asked[: self.calls - CALLS_AT_ONCE - 1]

    @property
    def together(self) -> list[Event]:
        """The calls that were sent at the same time."""
        return self.asked[self.calls - CALLS_AT_ONCE - 1 : self.calls - 1]

    @property
    def last(self) -> list[Event]:
        """The single call after all others; empty if it was not made."""
        return self.asked[self.calls - 1 :]

    @cached_property
    def answers(self) -> dict[int, Fields]:
        """The answers, by the number of the call."""
        return {int(event.data["call"]): event.data["fields"] for event in self.part.of("answered")}

    @property
    def count(self) -> int:
        """The largest number of servers with this name that existed at the same time."""
        return common.servers(self.part)

    def objections(self, calls: Sequence[Event], objection: Objection) -> list[str]:
        """Return in words what is wrong with the answers to the given calls, or that an answer is missing."""
        asked = [(call.data["fields"], self.answers.get(int(call.data["call"]))) for call in calls]
        found = (
            _unanswered(request) if answer is None else objection(request, answer)
            for request, answer in asked
        )
        return [words for words in found if words]

    def all_right(self, calls: Sequence[Event], objection: Objection, expected: str) -> Finding:
        """Decide whether all given calls were made and answered correctly.

        If two servers have the same name, chance decides which of them answers a call. So one wrong answer counts
        against every call, because any of them could have received it. If the server ended by itself, chance decides
        which calls came before its end. So no criterion about calls is met.

        Args:
            calls: Some of the calls in :attr:`asked`.
            objection: Returns in words what is wrong with one answer.
            expected: The expected behavior in words for the card.
        """
        wrong = self.objections(self.asked if self.count > 1 else calls, objection)
        many = "1 more call answered" if len(calls) == 1 else f"{len(calls)} calls answered"
        right = f"{many}, as expected" if calls else "not asked any more" if self.asked else "not asked"
        if ended := self.part.ending is not None:
            right = "the program ended by itself"
        return Finding(bool(calls) and not wrong and not ended, expected, wrong[0] if wrong else right)


def _unanswered(request: Fields) -> str:
    return f"no answer to {', '.join(f'{name} = {value}' for name, value in request.items()) or 'a call'}"


class Asks:
    """The recipe for a service server.

    The recipe recognizes the mistakes ``two_servers``, ``service_name``, ``message_type``,
    ``callback_returned_none``.

    Args:
        singly: Draws the requests for the calls that are made one after the other.
        ordinary: Draws one request; it is called for each of the simultaneous calls and for the last one.

    Example::

        asks = Asks(lambda random: [{"a": 2, "b": random.randint(10, 99)}] * 3, lambda random: {"a": 5, "b": 7})
        adder = Draft("lab_8_1.adder", "Lab 8.1 · The adder", "Answer each request with the sum.", asks)
        adder.asks("service", "Serves add_two_ints, with the right type", asks.serves, points=2)

        def wrong(request: Fields, answer: Fields) -> str:
            return "" if answer["sum"] == request["a"] + request["b"] else "a wrong sum"

        adder.asks("sums", "Answers with the sum", asks.right("singly", wrong, "the sum, for every request"), points=8)
    """

    roles = ("service",)

    def __init__(
        self, singly: Callable[[Random], Sequence[Fields]], ordinary: Callable[[Random], Fields]
    ) -> None:
        self._singly, self._ordinary = singly, ordinary

    def scenario(self, bench: Bench) -> None:
        """Make one run: single calls, several calls at once, and one more call."""
        meet(bench, CALLS, lambda met: self._all_answered(bench, met.callers[0]), only="service")

    def _all_answered(self, bench: Bench, caller: Caller) -> bool:
        """Make all calls. Return False at the first one that is not answered."""
        random = bench.random
        singly = [[request] for request in self._singly(random)]
        for requests in (*singly, [self._ordinary(random) for _ in range(CALLS_AT_ONCE)]):
            caller.ask(*requests)
            if not caller.await_answers(QUIET[bench.pace]):
                return False
        bench.pass_time(random.uniform(*LIVES_ON), "service", bench.reference.only("service")[0])
        caller.ask(self._ordinary(random))
        return caller.await_answers(QUIET[bench.pace])

    def seen(self, evidence: Evidence) -> ServerSeen:
        """Return the subject's server, with the calls that the judge made and the answers."""
        return ServerSeen(evidence.main, len(evidence.reference.part(CALLS).of("asked")))

    def expected(self, evidence: Evidence) -> ServerSeen:
        """Return the server of the recorded reference solution."""
        part = evidence.reference.part(CALLS)
        return ServerSeen(part, len(part.of("asked")))

    def serves(self, evidence: Evidence) -> Finding:
        """Decide whether the subject has exactly one server with the right name and type, and it answers.

        A server whose callback raised an exception was there, so the exception costs only the answers.
        """
        name, type_name = evidence.reference.only("service")
        seen, expected = self.seen(evidence), f"one server of {name} ({type_name}) that answers"
        if wrong := common.misfit(evidence, "service"):
            return Finding(False, expected, wrong)
        raised = bool(seen.asked and seen.part.traceback)
        if seen.part.ending is not None and not raised:
            return Finding(False, expected, "the program ended by itself while the judge called its service")
        answered = bool(seen.answers)
        return Finding(
            answered or raised,
            expected,
            "it answers"
            if answered
            else "its callback raised an exception"
            if raised
            else "no call was answered",
        )

    def right(
        self, calls: Literal["singly", "together", "last"], objection: Objection, expected: str
    ) -> Callable[[Evidence], Finding]:
        """Return a function that decides whether some of the calls were answered, and answered right.

        Args:
            calls: Which calls: those made one at a time, those made at once, or the last one.
            objection: Returns in words what is wrong with one answer.
            expected: The expected behavior in words for the card.
        """

        def judge(evidence: Evidence) -> Finding:
            seen = self.seen(evidence)
            return seen.all_right(getattr(seen, calls), objection, expected)

        return judge

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        # A wrong answer is looked for before crashes: rclpy's server crashes if an answer does not fit into its field,
        # and then the student should read about the answer, not about the crash.
        return ladder(self.roles, first=(OWN,), named=())
