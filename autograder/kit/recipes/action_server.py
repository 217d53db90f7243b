"""A recipe for an action server. The judge sends it several goals, and cancels one while the server works on it."""

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
"""A limit in seconds. A server that computes many numbers in less time makes no pause for each number."""
MANY = 2
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
        """Return advice if the server aborted a goal that should have succeeded, without an exception."""
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
        unread = long.cancelled_too_late and long.unread >= MANY
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
        if long.cancel_accepted or long.unread < MANY or is_quick(long):
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
    return seen.seconds is not None and seen.seconds < AT_ONCE


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
