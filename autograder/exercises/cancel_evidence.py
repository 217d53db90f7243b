"""What the runs of Exercise 1.3 show of a client: its goal, when it asked to cancel, what it said of the end."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.exercises.evidence import Event, Evidence, Part

HONOURED = "the server cancels"
REFUSED = "the server refuses to cancel"

FIRST_FEEDBACK, LAST_FEEDBACK = 3, 5
"""The cancel request must come after this many feedback messages, at the earliest and at the latest."""
_NUMBER = re.compile(r"\d+(?:\.\d+)*")


@dataclass(frozen=True)
class Request:
    """A request to cancel.

    Attributes:
        count: How many feedback messages were sent before it.
        after: Seconds of wall time from the goal to it.
    """

    count: int
    after: float


def goals(part: Part) -> list[Event]:
    """The goals that were sent."""
    return part.of("goal")


def expected_order(evidence: Evidence) -> int:
    """The order that the reference solution asks for."""
    return int(goals(evidence.reference.part(HONOURED))[0].data["fields"]["order"])


def orders(evidence: Evidence) -> list[int]:
    """The orders of the goals that were sent in the first run."""
    return [int(goal.data["fields"]["order"]) for goal in goals(evidence.main)]


def feedbacks_before_cancel(part: Part) -> int | None:
    """How many feedback messages were sent before the first cancel request; None where none came."""
    cancel = part.first("cancel")
    if cancel is None:
        return None
    before = part.events[: part.events.index(cancel)]
    return sum(event.kind == "feedback" for event in before)


def request_of(part: Part) -> Request | None:
    """The first request to cancel; None where none came."""
    goal, cancel, count = part.first("goal"), part.first("cancel"), feedbacks_before_cancel(part)
    if goal is None or cancel is None or count is None:
        return None
    return Request(count, cancel.t - goal.t)


def telling_count(evidence: Evidence) -> int | None:
    """How many feedback messages were sent before the cancel request, in the run where that is least right."""
    counts = [feedbacks_before_cancel(part) for part in evidence if goals(part)] or [None]
    return next((n for n in counts if n is None or not FIRST_FEEDBACK <= n <= LAST_FEEDBACK), counts[0])


def after_result(part: Part) -> list[str]:
    """What was said after the result."""
    result = part.first("result")
    return part.said(after=result) if result else []


def says_canceled(lines: Sequence[str], elsewhere: Sequence[str] = (), otherwise: Sequence[str] = ()) -> bool:
    """Whether a line names the status CANCELED, by its name or by its number 5 (action_msgs/msg/GoalStatus).

    Args:
        lines: What was said.
        elsewhere: What was said in the run with a goal that was not canceled: a 5 in the same place of a line there is
            no status.
        otherwise: What was said there of how the goal ended: a name that is in the same line there tells nothing.
    """
    ends = {_shape(line) for line in otherwise}
    return any(
        (_names_canceled(line) and _shape(line) not in ends) or _has_the_number(line, elsewhere)
        for line in lines
    )


def _has_the_number(line: str, elsewhere: Sequence[str]) -> bool:
    twins = [_numbers(other) for other in elsewhere if _shape(other) == _shape(line)]
    return any(
        number == "5" and all(twin[place] != "5" for twin in twins)
        for place, number in enumerate(_numbers(line))
    )


def _numbers(line: str) -> list[str]:
    return _NUMBER.findall(_without_lists(line))


def _shape(line: str) -> str:
    """A line with a place for each number, so that two lines for two goals can be compared."""
    return _NUMBER.sub("#", _without_lists(line))


def _names_canceled(line: str) -> bool:
    return re.search(r"cancel|abgebrochen|annul", _without_lists(line), re.IGNORECASE) is not None


def _without_lists(line: str) -> str:
    # The numbers of a sequence are not a status.
    return re.sub(r"\[[^\]]*\]|\([\d, ]*\)", "", line)


def false_claim(refused: Part) -> str | None:
    """What it says that amounts to "the goal was canceled" although the goal succeeded."""
    if refused.first("result_request") is None:
        return None
    said = after_result(refused)
    honest = r"succe|not |n't|4|refus|reject|fail|nicht|erfolg|unable|could|instead|denied|unknown"
    said = said or refused.said()
    claims = [line for line in said if _names_canceled(line)]
    if not claims or any(re.search(honest, _without_lists(line), re.IGNORECASE) for line in said):
        return None
    return claims[-1]
