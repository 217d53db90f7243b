"""Known mistakes of clients that send a goal and report how the goal ended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.goal_reports import (
    ABORTED,
    LATE,
    NO_GOAL,
    NOT_AWAITED,
    NOT_ENDED,
    REFUSED,
    REJECTED,
    WAS_ABORTED,
    aborted_as_seen,
    all_but,
    asked_for,
    goals_as_seen,
    left_at_once,
    refused_as_seen,
    reports_result,
    returned_instead,
    said_of_result,
    unshown_feedback,
)
from autograder.kit.mistakes.crashes import meant, on_purpose
from autograder.kit.model import Advice, Mistake, card_words, filled_in, mistake
from autograder.kit.reported_texts import mentions, not_filled_in

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence

_WORDS = card_words(__file__)


# --- the server, and the goal -------------------------------------------------------------------------------------


def _order_never_filled(evidence: Evidence) -> bool:
    made = [order for part in evidence if part.inputs.get("order") != 0 for order in asked_for(part)]
    return bool(made) and not any(made)


ORDER_NEVER_FILLED = mistake("field_typo", _order_never_filled, *_WORDS["field_typo"], certain=True)


def _wrong_order(evidence: Evidence) -> str:
    wrong = goals_as_seen(evidence)
    return "" if wrong == NOT_AWAITED or wrong.startswith(NO_GOAL) else wrong


WRONG_ORDER = mistake("wrong_order", _wrong_order, *_WORDS["wrong_order"], certain=True)


def _ended_before(evidence: Evidence) -> str:
    """Return in words how early the client ended; empty if it waited for all answers."""
    part = evidence.part(LATE)
    ending, answered, result = part.ending, part.first("goal_answered"), part.first("result")
    if not asked_for(part) or ending is None or (part.traceback and not meant(part.traceback)):
        return ""
    events = list(part.events)
    took = part.first("feedback") is not None and len(unshown_feedback(part)) < len(part.of("feedback"))
    if answered is None or (not took and left_at_once(part)):
        return "before it could process the answer"
    if part.first("result_request") and (result is None or events.index(ending) < events.index(result)):
        return "before the result arrived that it had requested"
    return ""


ENDED_TOO_EARLY = mistake("ended_too_early", _ended_before, *_WORDS["ended_too_early"])

# --- a goal that is refused ---------------------------------------------------------------------------------------

RESULT_OF_REJECTED_GOAL = mistake(
    "result_of_rejected_goal",
    lambda evidence: evidence.part(REFUSED).first("result_request"),
    *_WORDS["result_of_rejected_goal"],
)


def crashed_by_refusal(evidence: Evidence) -> bool:
    """Return True if an exception stops the client only in the run in which its goal is rejected."""
    crashed = [part for part in evidence if part.traceback and not on_purpose(part.traceback)]
    return [part.name for part in crashed] == [REFUSED]


STAYS_AFTER_REFUSAL = mistake(
    "never_ended", lambda evidence: refused_as_seen(evidence) == NOT_ENDED, *_WORDS["never_ended"]
)


def _refusal_not_reported(evidence: Evidence) -> Advice | None:
    part, others = evidence.part(REFUSED), all_but(evidence, REFUSED)
    if not part.first("goal") or not REJECTED.missing(part, others):
        return None
    return REJECTED.advice(
        part,
        others,
        "The goal was rejected",
        "Check `accepted` of the goal handle when the answer to the goal has arrived. If it is False, log an error "
        "with the word `rejected`, and end: there is no result to wait for.",
    )


REFUSAL_NOT_REPORTED = Mistake("refusal_not_reported", _refusal_not_reported)

# --- what comes back ----------------------------------------------------------------------------------------------


def _feedback_not_shown(evidence: Evidence) -> tuple[int, int] | None:
    """Return how many feedback messages were sent, and how many the client showed; None if it showed enough."""
    part = evidence.part(LATE)
    sent, missing = len(part.of("feedback")), len(unshown_feedback(part))
    return (sent, sent - missing) if missing and part.first("result_request") else None


FEEDBACK_NOT_SHOWN = mistake("feedback_not_shown", _feedback_not_shown, *_WORDS["feedback_not_shown"])
RESULT_NOT_REQUESTED = mistake(
    "result_not_reported",
    lambda evidence: asked_for(evidence.part(LATE)) and not evidence.part(LATE).first("result_request"),
    *_WORDS["result_not_reported"],
)


def _result_not_reported(evidence: Evidence) -> Advice | None:
    """Return advice if the client received the result and did not report it."""
    part = evidence.part(LATE)
    result = part.first("result")
    if result is None or part.first("result_request") is None or reports_result(part):
        return None
    numbers, said = result.data["fields"]["sequence"], said_of_result(part)
    left_out = [number for number in numbers if not mentions(said, number)]
    # A client that shows most numbers already logs the sequence; the advice to log it would not help.
    if len(left_out) < len(numbers) / 2:
        seen = (
            f"{left_out[-1]} is missing"
            if left_out
            else "they are not in order, or a number that occurs twice is shown only once"
        )
        return filled_in(_WORDS["result_not_whole"], many=len(numbers), seen=seen)
    return filled_in(_WORDS["result_not_shown"])


RESULT_NOT_REPORTED = Mistake("result_not_reported", _result_not_reported)


def _abort_not_reported(evidence: Evidence) -> Advice | None:
    part, others = evidence.part(ABORTED), all_but(evidence, ABORTED)
    if part.first("result_request") is None or not aborted_as_seen(evidence):
        return None
    return not_filled_in(said_of_result(part)) or WAS_ABORTED.advice(
        part,
        others,
        "The goal was aborted (status 6)",
        "Read the status that comes with the result: log its name, or its number after the word `status`.",
    )


ABORT_NOT_REPORTED = Mistake("abort_not_reported", _abort_not_reported)


def _returns_another_value(evidence: Evidence) -> tuple[str, str] | None:
    """Return the wrong value of a notebook's function, and the expected value, in words; None if it is right."""
    late, refused = evidence.part(LATE), evidence.part(REFUSED)
    result = late.first("result")
    if result and (value := returned_instead(late, result.data["fields"]["sequence"])):
        return value, "but should return the sequence of its goal's result as a list"
    value = returned_instead(refused, []) if refused.first("goal") else ""
    return (value, "but should return an empty list if its goal is rejected") if value else None


NOT_RETURNED = mistake("not_returned", _returns_another_value, *_WORDS["not_returned"])
