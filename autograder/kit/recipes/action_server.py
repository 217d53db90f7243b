"""A recipe for an action server. The judge sends it goals, one of which it cancels while the server works on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit.draft import OWN, OWN_LATE, SeenAsItIs
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, raised, traceback_of
from autograder.kit.model import Advice, Mistake
from autograder.kit.reading.goals_seen import ABORTED, CANCELED, all_goals, status_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.evidence import Evidence
    from autograder.kit.model import Bench
    from autograder.kit.reading.goals_seen import Goal

AT_ONCE = 0.3
"""Seconds: a server that computes many numbers within this time takes no time for each."""
MANY = 2
"""The minimum number of feedback messages in a row, without an answer to the cancel request, that show that the server
reads no requests while it works.
"""


class SendsGoals(SeenAsItIs):
    """The recipe for an action server. Its views are the evidence itself, because several runs have several goals.

    Args:
        scenario: Drives the bench. The action's name and type are ``bench.reference.only("action_server")``.
        good: The goals that should succeed.
        canceled: The goal that is canceled while the server works on it.
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
                "Each goal reaches both, and both execute it.",
                "Make one ActionServer only, and one node.",
            ),
            Mistake("result_missing", _result_missing, certain=True),
            # The mistakes in OWN come before all crashes, because a goal that should have been refused may cause a
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
        """Return advice if the server aborted a goal or did not report success for it."""
        aborted = [seen for seen in self._good(evidence) if seen.status == ABORTED]
        if not aborted or traceback_of(evidence):
            return None
        return Advice(
            "The goal ended as ABORTED (6) although the work was done: the execute callback called abort() or returned "
            "without a word about how the goal ended, which rclpy takes for abort().",
            "Call succeed() of the goal handle before you return the result. abort() is for work that has failed.",
        )

    def _cancel_refused(self, evidence: Evidence) -> Advice | None:
        """Return advice if the server refused the cancel request."""
        long = self.canceled(evidence)
        if long.cancelled_too_late and long.sent_after(long.cancel_answered_at):
            return Advice(
                "Your server ended the goal before its work was done: the request to cancel was refused because the "
                "goal had ended, and feedback went on.",
                "Call succeed(), canceled() or abort() of the goal handle once, as the last thing before you return "
                "the result.",
            )
        unread = long.cancelled_too_late and long.unread >= MANY
        if long.cancel_accepted is not False or unread or is_quick(long):
            return None
        return Advice(
            "Your server refuses to cancel: rclpy does so if the ActionServer has no cancel_callback, or one that "
            "returns anything but CancelResponse.ACCEPT.",
            "Write cancel_callback=... in the ActionServer, with a method that returns CancelResponse.ACCEPT, and look "
            "at is_cancel_requested of the goal handle in the loop.",
        )

    def _cancel_refused_on_its_way(self, evidence: Evidence) -> Advice | None:
        """Return the same advice only if the goal had not ended, so that the timing of the request does not matter."""
        return None if self.canceled(evidence).cancelled_too_late else self._cancel_refused(evidence)

    def _cancel_not_read(self, evidence: Evidence) -> Advice | None:
        """Return advice if the server works on and does not answer the cancel request."""
        long = self.canceled(evidence)
        if long.cancel_accepted or long.unread < MANY or is_quick(long):
            return None
        if any(seen.accepted and not seen.over for seen in self._good(evidence)):
            return None  # a thread is stuck in that goal
        return Advice(
            "Your server works on and does not even read the cancel request: the one thread that spins the node is "
            "busy with the execute callback.",
            "Spin the node with a MultiThreadedExecutor (rclpy.spin(your_node, executor=MultiThreadedExecutor())), so "
            "that another thread can take the request.",
        )

    def _cancel_ignored(self, evidence: Evidence) -> Advice | None:
        """Return advice if the server accepted the cancel request and worked on."""
        long = self.canceled(evidence)
        if not long.cancel_accepted or long.status == CANCELED:
            return None
        return Advice(
            "Your server accepted the cancel request, but the goal was not canceled "
            f"(status {status_text(long.status)}).",
            "In each turn of the loop look at is_cancel_requested of the goal handle; if it is True, call its "
            "canceled() and return the result so far.",
        )


def is_quick(seen: Goal) -> bool:
    """Return True if the server took hardly any time for the goal."""
    return seen.seconds is not None and seen.seconds < AT_ONCE


def _result_missing(evidence: Evidence) -> Advice | None:
    """Return advice if the execute callback returned no result."""
    _, kind = evidence.reference.only("action_server")
    fields = next(
        (list(seen.result) for part in evidence.reference.parts for seen in all_goals(part) if seen.result),
        [],
    )
    # The first is rclpy's error when it sends the result; the second is the clearer one of autograder/notebook.
    absent = rf"'NoneType' object has no attribute '_?(?:{'|'.join(fields)})'|" if fields else ""
    said = f"{absent}must return a result of the action"
    traceback = traceback_of(evidence)
    if not re2.search(said, traceback):
        return None
    name = kind.rpartition("/")[2]
    return Advice(
        f"The execute callback returned no {name}.Result: nothing at all, a bare list, or a type without parentheses.",
        f"End it with `return result`, where result is a {name}.Result() whose "
        f"{' and '.join(fields) or 'fields'} you have filled. Do so on every way out, after a cancel too.",
        traceback,
    )


def _exception_in_execute(evidence: Evidence) -> Advice | None:
    """Return advice if the execute callback raised an exception, upon which rclpy aborted the goal."""
    traceback = traceback_of(evidence)
    if not traceback or not any(seen.status == ABORTED for part in evidence for seen in all_goals(part)):
        return None
    return raised("The execute callback raised an exception, so rclpy aborted the goal", traceback)
