"""The goals that the judge sent to an action server, their outcomes, and which of them tests what."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.model import Finding
from autograder.kit.outcomes import CANCELED, SentGoal

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from autograder.kit.evidence import Evidence

NO_TIME = 0.009
"""Seconds between two feedback messages that no pause makes: the shortest that a person would write is longer, and in a
notebook none is made shorter than that. Two goals that never pause take turns of Python's 0.005 s.
"""
HURRIED, HURRIED_ALONE = 0.25, 0.5
"""The share of such short intervals from which on a server is taken not to pause: of all, and of the few of those goals
that do not compete with another one if none takes time.
"""
ENDED = "the program ended by itself"
ROUNDS_LEFT = 2
"""Feedback messages that a server may still send after it agreed to cancel: in its present round, and in the next one
if it checked too early.
"""


@dataclass(frozen=True)
class ComparedGoal(SentGoal):
    """A goal of an exercise, and in words what is wrong about it; empty if nothing is.

    Attributes:
        due: What the reference solution returns.
        fault: What is wrong with the end of a goal that should succeed.
        slip: What is wrong with the feedback that came, however many messages are missing before or after it.
        feedback_fault: What is wrong with all its feedback.
        is_wrong_when_large: True if the goal is right as long as another one may run beside it, and wrong later.
    """

    due: Any
    fault: str
    slip: str
    feedback_fault: str
    is_wrong_when_large: bool = False


@dataclass(frozen=True)
class GoalsSeen:
    """An action server, and the goals that the judge sent to it. An exercise says which goal is which.

    Attributes:
        evidence: What the judge saw.
        alone: The goals that should succeed and have the server to themselves.
        beside: The goals that should succeed while another one is at work.
        later: The goals after the first one that should be like it; first the one beside another goal.
        welcome: All goals that should be accepted.
        bad: The goals that should be refused.
        last: The goals after the bad ones.
        canceled: The goals that the judge cancels while the server works on them. The first one has to be sent.
        ended_for_another: A goal that the server ended, unasked, when a newer one came; None if it did not.
    """

    evidence: Evidence
    alone: Sequence[ComparedGoal]
    beside: Sequence[ComparedGoal]
    later: Sequence[ComparedGoal]
    welcome: Sequence[ComparedGoal]
    bad: Sequence[ComparedGoal]
    last: Sequence[ComparedGoal]
    canceled: Sequence[ComparedGoal]
    ended_for_another: SentGoal | None

    @property
    def good(self) -> list[ComparedGoal]:
        """All goals that should succeed."""
        return [*self.alone, *self.beside]

    @property
    def part_fault(self) -> str:
        """What is wrong with the result of the first goal that was canceled, in words; empty if nothing is."""
        return ""

    @property
    def astray(self) -> list[ComparedGoal]:
        """The goals that the server agreed to cancel and went on with, although it can cancel a goal."""
        # If the server never pauses, chance decides which of its goals can be canceled.
        can_cancel = not self.takes_no_time and any(one.status == CANCELED for one in self.canceled)
        return [one for one in self.canceled if can_cancel and one.cancel_accepted and one.status != CANCELED]

    @property
    def takes_no_time(self) -> bool:
        """True if the server works without any pause between two feedback messages.

        Such a goal is over before it can be canceled, unless the machine happens to be so busy that the request gets in
        between. A busy machine makes intervals longer and never shorter, and no server that pauses can send two
        messages at once. So the short intervals tell, however few they are; a pause that makes up for an earlier one (a
        rate's) is allowed for.
        """
        shares = ((HURRIED, (*self.good, self.canceled[0])), (HURRIED_ALONE, self.alone))
        return any(_hurries(*share) for share in shares) and not self.tells_at_the_end

    @property
    def tells_at_the_end(self) -> bool:
        """True if the server works in silence, and sends all feedback of a goal at once when it is done."""
        told = [one.told_at_the_end for one in self.good if one.pauses]
        return len(told) > 1 and all(told)

    def find(self, faults: Iterable[str], expected: str, right: str, *, reached: bool = True) -> Finding:
        """Decide a criterion about goals.

        If two servers have the action's name, each goal reaches both, and chance decides whose answers the client
        takes. If the program ended by itself, chance decides which goals came before its end. So neither meets any
        criterion about goals.

        Args:
            faults: What is wrong, in words; empty texts do not count.
            expected: The expected behavior, in words for the card.
            right: What was seen if nothing is wrong.
            reached: False if the judge did not send the goals that the criterion is about.
        """
        part, count = self.evidence.main, common.servers(self.evidence.main)
        unfit = f"each goal reached {count} servers" if count > 1 else ""
        if part.ending is not None and not part.traceback:
            unfit = ENDED
        wrong = unfit or next(filter(None, faults), "") or ("" if reached else "not reached")
        return Finding(not wrong, expected, wrong or right)


def _hurries(share: float, goals: Iterable[SentGoal]) -> bool:
    pauses = sorted(pause for one in goals for pause in one.pauses)
    return bool(pauses) and pauses[int(len(pauses) * share)] < NO_TIME
