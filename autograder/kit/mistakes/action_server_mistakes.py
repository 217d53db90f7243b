"""Mistakes of every action server: in its execute callback, and in its answer to a cancel request."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit.mistakes.crashes import raised, traceback_of
from autograder.kit.model import Advice, Mistake, card_words, filled_in, mistake
from autograder.kit.outcomes import ABORTED, all_goals

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence
    from autograder.kit.outcomes import SentGoal

_WORDS = card_words(__file__)


def _result_missing(evidence: Evidence) -> Advice | None:
    """Return advice if the execute callback returned no result."""
    result, fields = result_type(evidence)
    # The first alternative is rclpy's error when it sends the result. The second is the clearer error that
    # autograder/notebook raises.
    absent = (
        rf"'NoneType' object has no attribute '_?(?:{'|'.join(fields)})'"
        if fields
        else "in _send_result_response"
    )
    said = f"{absent}|must return a result of the action"
    traceback = traceback_of(evidence)
    if not re2.search(said, traceback):
        return None
    return filled_in(
        _WORDS["result_missing"],
        traceback=traceback,
        result=result,
        fields=" and ".join(fields) or "the fields",
    )


def result_type(evidence: Evidence) -> tuple[str, list[str]]:
    """Return the name of the result type of the subject's action, and its fields."""
    _, kind = evidence.reference.only("action_server")
    recorded = (
        list(one.result) for part in evidence.reference.parts for one in all_goals(part) if one.result
    )
    return f"{kind.rpartition('/')[2]}.Result", next(recorded, [])


def _exception_in_execute(evidence: Evidence) -> Advice | None:
    """Return advice if the execute callback raised an exception, so that rclpy aborted the goal."""
    traceback = traceback_of(evidence)
    if not traceback or not any(seen.status == ABORTED for part in evidence for seen in all_goals(part)):
        return None
    return raised("The execute callback raised an exception, so rclpy aborted the goal", traceback)


def _first_canceled(evidence: Evidence) -> SentGoal | None:
    """Return the goal of the first cancel request that the server answered; None if it answered none."""
    answered = (one for part in evidence for one in all_goals(part) if one.cancel_accepted is not None)
    return next(answered, None)


def _refuses_to_cancel(evidence: Evidence) -> bool:
    """Return True if the server refused the first cancel request that it answered, for a goal that had not ended."""
    first = _first_canceled(evidence)
    return first is not None and not (first.cancel_accepted or first.cancelled_too_late or first.is_quick)


def _reads_no_request(evidence: Evidence) -> bool:
    """Return True if the first cancel request that was answered waited until the goal's end, while feedback came."""
    first = _first_canceled(evidence)
    if first is None or not first.cancelled_too_late or first.is_quick:
        return False
    return first.unread >= UNREAD and not first.sent_after(first.cancel_answered_at)


UNREAD = 2
"""If this many feedback messages arrive after the cancel request and before its answer, the server reads no requests
while it works.
"""
NO_FREE_THREAD = _WORDS["no_free_thread"]
"""What a server does that reads no cancel request while it works, and the next step."""
RESULT_MISSING = Mistake("result_missing", _result_missing, certain=True)
EXCEPTION_IN_EXECUTE = Mistake("exception_in_callback", _exception_in_execute, certain=True)
CANCEL_REFUSED = mistake(
    "cancel_not_accepted", _refuses_to_cancel, *_WORDS["cancel_not_accepted"], certain=True
)
CANCEL_UNREAD = mistake("cancel_not_accepted", _reads_no_request, *NO_FREE_THREAD)
