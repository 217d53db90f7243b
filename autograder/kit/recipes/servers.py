"""Recipes for servers: the judge calls a service one by one and at once, or sends an action goals and cancels one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import re2

from autograder.kit.draft import OWN, OWN_LATE, SeenAsItIs
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, raised, traceback_of
from autograder.kit.model import Advice, Bench, Finding, Mistake, Pace
from autograder.kit.outcomes import ABORTED, CANCELED, all_goals, status_text

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.counterparts import Caller
    from autograder.kit.evidence import Event, Evidence, Part
    from autograder.kit.outcomes import Goal


CALLS = "calls"
CALLS_AT_ONCE = 6
"""The number of simultaneous calls. It is less than 10, because the queue of a service holds 10 requests: with 12
calls, even a right server lost some (measured).
"""
SERVER_LIMIT = {Pace.FAST: 3.0, Pace.REAL_TIME: 6.0}
"""Time limit in seconds until a server on the ROS graph is connected with the judge's client."""
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

    Args:
        singly: Draws the requests for the calls that are made one after the other.
        ordinary: Draws one request; it is called for each of the simultaneous calls and for the last one.

    Example::

        asks = Asks(lambda random: [{"a": 2, "b": random.randint(10, 99)}] * 3, lambda random: {"a": 5, "b": 7})
        adder = Draft("lab_8_1.adder", "Lab 8.1 · The adder", "Answer each request with the sum.", asks)
        adder.asks("service", 2, "Serves add_two_ints, with the right type", asks.serves)

        def wrong(request: Fields, answer: Fields) -> str:
            return "" if answer["sum"] == request["a"] + request["b"] else "a wrong sum"

        adder.asks("sums", 8, "Answers with the sum", asks.right("singly", wrong, "the sum, for every request"))
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


IMMEDIATELY = 0.3
"""A limit in seconds. A server that computes many numbers in less time makes no pause for each number."""
UNREAD = 2
"""If this many feedback messages arrive after the cancel request and before its answer, the server reads no requests
while it works.
"""


class SendsGoals(SeenAsItIs):
    """The recipe for an action server. Its views are the whole evidence, because the goals are in several runs.

    Args:
        scenario: The function that runs all parts of the exercise on a bench. The action's name and type are
            ``bench.reference.only("action_server")``.
        good: Returns the goals that should succeed.
        canceled: Returns the goal that the judge cancels while the server works on it.

    Example::

        def scenario(bench: Bench) -> None:
            bench.part("goals")
            caller = bench.call_action(*bench.reference.only("action_server"))
            bench.start()
            bench.release()
            if caller.await_server(15.0):
                caller.send_goal(order=5)
                bench.wait_until(lambda evidence: bool(evidence.main.first("result_heard")), 15.0)
                caller.cancel(caller.send_goal(order=100))
                bench.wait_until(lambda evidence: len(evidence.main.of("result_heard")) == 2, 15.0)
            bench.stop()

        recipe = SendsGoals(scenario, good=lambda e: [goal(e.main, 0)], canceled=lambda e: goal(e.main, 1))
    """

    roles = ("action_server",)

    def __init__(
        self,
        scenario: Callable[[Bench], None],
        *,
        good: Callable[[Evidence], Sequence[Goal]],
        canceled: Callable[[Evidence], Goal],
    ) -> None:
        self.scenario, self._good, self.canceled = scenario, good, canceled

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        return (
            common.two_servers(
                "action_server",
                "Each goal reaches both servers, and both execute it.",
                "Make only one ActionServer and only one node.",
            ),
            Mistake("result_missing", _result_missing, certain=True),
            # The exercise's own mistakes come before crashes, because a goal that should have been refused may cause a
            # crash.
            OWN,
            *CRASHES,
            common.endpoint_name("action_server"),
            common.message_type("action_server"),
            Mistake("exception_in_callback", _exception_in_execute, certain=True),
            *OTHER_CRASHES,
            Mistake("goal_not_succeeded", self._goal_not_succeeded, certain=True),
            Mistake("cancel_not_accepted", self._cancel_refused_on_its_way, certain=True),
            Mistake("cancel_not_accepted", self._cancel_refused),
            Mistake("cancel_not_accepted", self._cancel_not_read),
            Mistake("cancel_ignored", self._cancel_ignored),
            OWN_LATE,
            *common.spinning("action_server"),
            *unfinished.NOTHING_THERE,
        )

    def _goal_not_succeeded(self, evidence: Evidence) -> Advice | None:
        """Return advice if the server aborted a good goal although its callback raised no exception."""
        aborted = [seen for seen in self._good(evidence) if seen.status == ABORTED]
        if not aborted or traceback_of(evidence):
            return None
        return Advice(
            "The goal ended as ABORTED (6) although the work was done. Either the execute callback called abort(), "
            "or it returned without calling succeed(); rclpy then aborts the goal.",
            "Call succeed() of the goal handle before you return the result. Call abort() only if the work has failed.",
        )

    def _cancel_refused(self, evidence: Evidence) -> Advice | None:
        """Return advice if the server refused the cancel request."""
        long = self.canceled(evidence)
        if long.cancelled_too_late and long.sent_after(long.cancel_answered_at):
            return Advice(
                "Your server ended the goal before its work was done. So the cancel request was refused, because the "
                "goal had already ended, but the server still sent feedback.",
                "Call succeed(), canceled() or abort() of the goal handle exactly once, just before you return the "
                "result.",
            )
        unread = long.cancelled_too_late and long.unread >= UNREAD
        if long.cancel_accepted is not False or unread or is_quick(long):
            return None
        return Advice(
            "Your server refuses the cancel request. rclpy does this if the ActionServer has no cancel_callback, or "
            "if the cancel_callback does not return CancelResponse.ACCEPT.",
            "Pass cancel_callback=... to the ActionServer: a method that returns CancelResponse.ACCEPT. In the loop "
            "of the execute callback, check is_cancel_requested of the goal handle.",
        )

    def _cancel_refused_on_its_way(self, evidence: Evidence) -> Advice | None:
        """Return advice if the server refused the cancel request although the goal had not ended."""
        return None if self.canceled(evidence).cancelled_too_late else self._cancel_refused(evidence)

    def _cancel_not_read(self, evidence: Evidence) -> Advice | None:
        """Return advice if the server keeps working and does not answer the cancel request."""
        long = self.canceled(evidence)
        if long.cancel_accepted or long.unread < UNREAD or is_quick(long):
            return None
        if any(seen.accepted and not seen.over for seen in self._good(evidence)):
            return None  # A goal without a result may keep the only thread busy.
        return Advice(
            "Your server keeps working and does not read the cancel request, because the only thread that spins the "
            "node is busy with the execute callback.",
            "Spin the node with a MultiThreadedExecutor, as in rclpy.spin(your_node, "
            "executor=MultiThreadedExecutor()), so that another thread can read the cancel request.",
        )

    def _cancel_ignored(self, evidence: Evidence) -> Advice | None:
        """Return advice if the server accepted the cancel request, but did not end the goal as canceled."""
        long = self.canceled(evidence)
        if not long.cancel_accepted or long.status == CANCELED:
            return None
        return Advice(
            "Your server accepted the cancel request, but the goal was not canceled "
            f"(status {status_text(long.status)}).",
            "In each turn of the loop, check is_cancel_requested of the goal handle. If it is True, call canceled() "
            "of the goal handle and return the result so far.",
        )


def is_quick(seen: Goal) -> bool:
    """Return True if the server needed hardly any time for the goal."""
    return seen.seconds is not None and seen.seconds < IMMEDIATELY


def _result_missing(evidence: Evidence) -> Advice | None:
    """Return advice if the execute callback returned no result."""
    _, kind = evidence.reference.only("action_server")
    fields = next(
        (list(seen.result) for part in evidence.reference.parts for seen in all_goals(part) if seen.result),
        [],
    )
    # The first alternative is rclpy's error when it sends the result. The second is the clearer error that
    # autograder/notebook raises.
    absent = rf"'NoneType' object has no attribute '_?(?:{'|'.join(fields)})'|" if fields else ""
    said = f"{absent}must return a result of the action"
    traceback = traceback_of(evidence)
    if not re2.search(said, traceback):
        return None
    name = kind.rpartition("/")[2]
    return Advice(
        f"The execute callback did not return a {name}.Result object. It returned nothing, a plain list, or the type "
        "without parentheses.",
        f"End the callback with `return result`, where `result` is a {name}.Result() in which you have set "
        f"{' and '.join(fields) or 'the fields'}. Do this wherever the callback returns, also after a cancel.",
        traceback,
    )


def _exception_in_execute(evidence: Evidence) -> Advice | None:
    """Return advice if the execute callback raised an exception, so that rclpy aborted the goal."""
    traceback = traceback_of(evidence)
    if not traceback or not any(seen.status == ABORTED for part in evidence for seen in all_goals(part)):
        return None
    return raised("The execute callback raised an exception, so rclpy aborted the goal", traceback)
