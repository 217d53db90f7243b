"""A service's server: the judge calls it one by one, then several times at once, then once more."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from autograder.kit import common_mistakes as common
from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.hangs import HANGS
from autograder.kit.model import Bench, Finding, Mistake, Pace

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.counterparts import Caller
    from autograder.kit.evidence import Event, Evidence, Part

CALLS = "calls"
AT_ONCE = 6
"""The number of calls at once. A service's queue holds 10; with 12 even a right server loses some (measured)."""
SERVER_LIMIT = {Pace.FAST: 3.0, Pace.REAL_TIME: 6.0}
"""Seconds within which a server on the graph must be matched with the judge's client."""
QUIET = {Pace.FAST: 2.0, Pace.REAL_TIME: 6.0}
"""Seconds without any event after which an answer is no longer expected."""
SURE = 2
"""The number of answers after which a server that ended by itself had certainly served."""

Fields = Mapping[str, Any]
"""The fields of a request or of a response."""
Objection = Callable[[Fields, Fields | None], str]
"""Returns the fault of an answer to a request (None for no answer), in words; empty if it is right."""


@dataclass(frozen=True)
class Server:
    """A server, as it was seen.

    Attributes:
        part: The run in which it was called.
        calls: The number of calls if each of them is answered.
    """

    part: Part
    calls: int

    @property
    def asked(self) -> list[Event]:
        """All calls that were made, in order."""
        return self.part.of("asked")

    @property
    def singly(self) -> list[Event]:
        """The calls that are sent one at a time, each after the answer to the one before."""
        return self.asked[: self.calls - AT_ONCE - 1]

    @property
    def together(self) -> list[Event]:
        """The calls at once."""
        return self.asked[self.calls - AT_ONCE - 1 : self.calls - 1]

    @property
    def last(self) -> list[Event]:
        """The call after all others, if it was made."""
        return self.asked[self.calls - 1 :]

    @cached_property
    def answers(self) -> dict[int, Fields]:
        """The answer to each call that was answered, by the call's number."""
        return {int(event.data["call"]): event.data["fields"] for event in self.part.of("answered")}

    @property
    def count(self) -> int:
        """The largest number of servers of the name that existed at the same time."""
        return common.servers(self.part)

    def objections(self, calls: Sequence[Event], objection: Objection) -> list[str]:
        """Return the faults of the answers to these calls, in words."""
        found = (objection(e.data["fields"], self.answers.get(int(e.data["call"]))) for e in calls)
        return [words for words in found if words]

    def all_right(self, calls: Sequence[Event], objection: Objection, expected: str) -> Finding:
        """Judge that these calls were made and each was answered correctly.

        If two servers share the name, chance decides which of them answers a call. So one wrong answer counts against
        all calls: any of them could have received it.

        Args:
            calls: Some of :attr:`asked`.
            objection: Returns the fault of one answer.
            expected: The expectation for all of them, in words.
        """
        wrong = self.objections(self.asked if self.count > 1 else calls, objection)
        many = "1 more call answered" if len(calls) == 1 else f"{len(calls)} calls answered"
        right = f"{many}, as expected" if calls else "not asked any more" if self.asked else "not asked"
        return Finding(bool(calls) and not wrong, expected, wrong[0] if wrong else right)


class Asks:
    """The recipe for a server.

    Args:
        singly: Draws the requests that are made one by one.
        ordinary: Draws one request, for the calls at once and the last one.
    """

    roles = ("service",)

    def __init__(
        self, singly: Callable[[Random], Sequence[Fields]], ordinary: Callable[[Random], Fields]
    ) -> None:
        self._singly, self._ordinary = singly, ordinary

    def scenario(self, bench: Bench) -> None:
        """One run: calls one by one, calls at once, one more."""
        service, type_name = bench.reference.only("service")
        bench.part(CALLS)
        caller = bench.call(service, type_name)
        bench.start()
        there = bench.await_endpoint("service", service)
        bench.release()
        if there and caller.await_server(SERVER_LIMIT[bench.pace]) and not self._all_answered(bench, caller):
            bench.note_whether_it_spins()
            bench.note_where_it_hangs()
        bench.stop()

    def _all_answered(self, bench: Bench, caller: Caller) -> bool:
        """Make all calls; return False at the first unanswered one."""
        for request in self._singly(bench.random):
            caller.ask(request)
            if not caller.await_answers(QUIET[bench.pace]):
                return False
        for number in (AT_ONCE, 1):
            caller.ask(*(self._ordinary(bench.random) for _ in range(number)))
            if not caller.await_answers(QUIET[bench.pace]):
                return False
        return True

    def seen(self, evidence: Evidence) -> Server:
        """The subject, as it was seen."""
        return Server(evidence.main, len(evidence.reference.part(CALLS).of("asked")))

    def expected(self, evidence: Evidence) -> Server:
        """The reference solution, as it was recorded."""
        part = evidence.reference.part(CALLS)
        return Server(part, len(part.of("asked")))

    def serves(self, evidence: Evidence) -> Finding:
        """There is one server of the right name and type, and it answers."""
        name, type_name = evidence.reference.only("service")
        seen, expected = self.seen(evidence), f"one server of {name} ({type_name}) that answers"
        made = seen.part.endpoints("service")
        if name not in made:
            return Finding(False, expected, f"a service {', '.join(sorted(made))}" if made else "no service")
        if made[name] != type_name:
            return Finding(False, expected, f"{name} is a {made[name]}")
        if seen.count > 1:
            return Finding(False, expected, f"{seen.count} servers of {name}")
        # The answer of a program that exits with it may or may not arrive; one that crashes has not sent it.
        enough = SURE if seen.part.traceback else max(SURE, len(seen.asked))
        if seen.part.ending is not None and len(seen.answers) < enough:
            return Finding(False, expected, "it ended by itself while it was called")
        return Finding(bool(seen.answers), expected, "it answers" if seen.answers else "no call was answered")

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most telling first."""
        return (
            common.two_servers(
                "service",
                "Each call reaches both, and whichever is quicker answers.",
                "Call create_service once, and make one node only.",
            ),
            # Before any crash: a wrong answer may not fit into its field, and rclpy's server crashes then.
            OWN,
            *common.CRASHES,
            common.endpoint_name("service"),
            common.message_type("service"),
            *common.OTHER_CRASHES,
            *HANGS,
            common.never_spun("service"),
            common.went_deaf("service"),
            OWN_LATE,
            *common.NOTHING_THERE,
        )
