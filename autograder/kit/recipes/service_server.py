"""A recipe for a service server, to which the judge sends single calls, then several calls at once, then one more."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import unfinished
from autograder.kit.model import Bench, Finding, Mistake, Pace

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.counterparts import Caller
    from autograder.kit.evidence import Event, Evidence, Part

CALLS = "calls"
AT_ONCE = 6
"""The number of simultaneous calls. It is less than 10, because the queue of a service holds 10 requests: with 12
calls, even a right server lost some (measured).
"""
SERVER_LIMIT = {Pace.FAST: 3.0, Pace.REAL_TIME: 6.0}
"""Time limit in seconds until a server on the ROS graph is connected with the judge's client."""
QUIET = {Pace.FAST: 2.0, Pace.REAL_TIME: 6.0}
"""The seconds without any event after which the judge no longer waits for an answer, for each pace."""
SURE = 2
"""The minimum number of answers that prove that a server answers calls, even if it then ended by itself."""

Fields = Mapping[str, Any]
"""The fields of a request or of a response, by name."""
Objection = Callable[[Fields, Fields | None], str]
"""A function of a request and its answer (None for no answer) that returns in words what is wrong; empty if nothing is.
"""


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
        return self.asked[: self.calls - AT_ONCE - 1]

    @property
    def together(self) -> list[Event]:
        """The calls that were sent at the same time."""
        return self.asked[self.calls - AT_ONCE - 1 : self.calls - 1]

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
        """Return in words what is wrong with the answers to the given calls."""
        found = (objection(e.data["fields"], self.answers.get(int(e.data["call"]))) for e in calls)
        return [words for words in found if words]

    def all_right(self, calls: Sequence[Event], objection: Objection, expected: str) -> Finding:
        """Decide whether all given calls were made and answered correctly.

        If two servers have the same name, chance decides which of them answers a call. So one wrong answer counts
        against every call, because any of them could have received it.

        Args:
            calls: Some of the calls in :attr:`asked`.
            objection: Returns in words what is wrong with one answer.
            expected: The expected behavior in words for the card.
        """
        wrong = self.objections(self.asked if self.count > 1 else calls, objection)
        many = "1 more call answered" if len(calls) == 1 else f"{len(calls)} calls answered"
        right = f"{many}, as expected" if calls else "not asked any more" if self.asked else "not asked"
        return Finding(bool(calls) and not wrong, expected, wrong[0] if wrong else right)


class Asks:
    """The recipe for a service server.

    Args:
        singly: Draws the requests for the calls that are made one after the other.
        ordinary: Draws one request; it is called for each of the simultaneous calls and for the last one.
    """

    roles = ("service",)

    def __init__(
        self, singly: Callable[[Random], Sequence[Fields]], ordinary: Callable[[Random], Fields]
    ) -> None:
        self._singly, self._ordinary = singly, ordinary

    def scenario(self, bench: Bench) -> None:
        """Make one run: single calls, several calls at once, and one more call."""
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
        """Make all calls. Return False at the first one that is not answered."""
        for request in self._singly(bench.random):
            caller.ask(request)
            if not caller.await_answers(QUIET[bench.pace]):
                return False
        for number in (AT_ONCE, 1):
            caller.ask(*(self._ordinary(bench.random) for _ in range(number)))
            if not caller.await_answers(QUIET[bench.pace]):
                return False
        return True

    def seen(self, evidence: Evidence) -> ServerSeen:
        """Return the subject's server, with the calls that the judge made and the answers."""
        return ServerSeen(evidence.main, len(evidence.reference.part(CALLS).of("asked")))

    def expected(self, evidence: Evidence) -> ServerSeen:
        """Return the server of the recorded reference solution."""
        part = evidence.reference.part(CALLS)
        return ServerSeen(part, len(part.of("asked")))

    def serves(self, evidence: Evidence) -> Finding:
        """Decide whether the subject has exactly one server with the right name and type, and it answers."""
        name, type_name = evidence.reference.only("service")
        seen, expected = self.seen(evidence), f"one server of {name} ({type_name}) that answers"
        if wrong := common.misfit(evidence, "service"):
            return Finding(False, expected, wrong)
        # If a program answers and then ends at once, chance decides whether the answer arrives. If it crashes, it has
        # not sent an answer.
        enough = SURE if seen.part.traceback else max(SURE, len(seen.asked))
        if seen.part.ending is not None and len(seen.answers) < enough:
            return Finding(False, expected, "the program ended by itself while the judge called its service")
        return Finding(bool(seen.answers), expected, "it answers" if seen.answers else "no call was answered")

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        return (
            common.two_servers(
                "service",
                "Each call reaches both servers, and the quicker one answers.",
                "Call create_service only once, and make only one node.",
            ),
            # A wrong answer is looked for before crashes: rclpy's server crashes if an answer does not fit into its
            # field, and then the student should read about the answer, not about the crash.
            OWN,
            *common.connecting("service"),
            *common.spinning("service"),
            OWN_LATE,
            *unfinished.NOTHING_THERE,
        )
