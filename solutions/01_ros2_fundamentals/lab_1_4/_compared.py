"""What is wrong about the goals of Lab 1.4, compared with the sequence of the reference solution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lab_1_4._goals import (
    AGAIN,
    ALONE,
    BAD_ORDERS,
    BESIDE,
    CANCELED_ALONE,
    GOALS,
    LAST_ORDER,
    LONG,
    LONG_ALONE,
    LONG_ORDER,
    NEXT,
    TINY,
    YOUNGER,
    ended_by_a_younger,
)

from autograder.kit.oracle.goals_seen import ROUNDS_LEFT, ComparedGoal, GoalsSeen
from autograder.kit.outcomes import SUCCEEDED, all_goals, goal

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit import Evidence
    from autograder.kit.outcomes import SentGoal

SMALL = 20
"""Numbers of the large goal after which the others that run beside it are over."""
LONG_BEGINNING = 3
"""Numbers that the first feedback of a goal has at most: the two that it begins with, and a new one."""


@dataclass(frozen=True)
class Goals(GoalsSeen):
    """The server and its goals.

    Attributes:
        sent: Returns the goals of the first run with these numbers, as far as they were sent.
        longest: The longest sequence of the reference solution.
    """

    sent: Callable[..., list[ComparedGoal]]
    longest: list[int]

    @property
    def feedback_faults(self) -> list[str]:
        """What is wrong with the feedback of goals that have the server to themselves, or are not disturbed."""
        beside = [
            one for one in self.beside if one.over and not (one.fault or one.slip or self.may_have_lost(one))
        ]
        faults = [one.feedback_fault for one in (*self.sent(ALONE, AGAIN), *beside)]
        return [*faults, "all of it came at once, when the work was done" if self.tells_at_the_end else ""]

    def may_have_lost(self, goal: ComparedGoal) -> bool:
        """Return True if no feedback came, and the server sends it faster than a busy judge can take it in."""
        return self.takes_no_time and not goal.feedback

    @property
    def silent_again(self) -> SentGoal | None:
        """A goal without feedback although an equal one before it had some, if need be in the first look."""
        looks = (*(self.evidence.before or ()), *self.evidence)
        right = [one for part in looks for one in all_goals(part) if one.status == SUCCEEDED]
        for number, one in enumerate(right):
            equal = [
                other
                for other in right[:number]
                if (other.request, other.result) == (one.request, one.result)
            ]
            # Of a server that never pauses, a busy judge may lose feedback.
            if not (one.feedback or self.takes_no_time) and any(other.feedback for other in equal):
                return one
        return None

    @property
    def went_on(self) -> str:
        """What the server did for more than a round after it had agreed to cancel a goal, in words."""
        goal = self.canceled[0]
        late, count = goal.sent_after(goal.cancel_answered_at), len(_numbers(goal))
        told = 0 if any(self.feedback_faults) else max(map(len, _partials(goal)), default=0)
        if late <= ROUNDS_LEFT and count <= (told + ROUNDS_LEFT if told else LONG_ORDER):
            return ""
        return f"CANCELED with {count} numbers, {late} feedback messages after the cancel"

    @property
    def part_fault(self) -> str:
        """What is wrong with the numbers that came back from the canceled goal."""
        goal = self.canceled[0]
        numbers, told = _numbers(goal), _partials(goal)[: goal.before_cancel]
        known = numbers[: len(self.longest)]
        is_a_part = known == self.longest[: len(known)] and len(numbers) >= max([2, *map(len, told[-1:])])
        return self.went_on or ("" if is_a_part else f"CANCELED with {numbers}")


def goals_seen(evidence: Evidence) -> Goals:
    """Return the server's goals in all runs."""
    longest = max(map(_numbers, all_goals(evidence.reference.part(GOALS))), key=len)
    run = evidence.part(GOALS)
    first = [_compared(goal(run, number), longest) for number in range(YOUNGER + 1)]
    second, third = (
        [_compared(one, longest) for one in all_goals(evidence.part(name))]
        for name in (BAD_ORDERS, CANCELED_ALONE)
    )
    last = [one for one in second if len(one.due) == LAST_ORDER + 1]
    older = ended_by_a_younger(run)
    asked_again = older or (first[LONG].was_over_when_canceled and first[LONG_ALONE].accepted)
    later = [one for one in (first[YOUNGER], first[LONG_ALONE]) if one.accepted]

    def sent(*numbers: int) -> list[ComparedGoal]:
        return [first[number] for number in numbers if first[number].request is not None]

    return Goals(
        evidence,
        alone=sent(ALONE, AGAIN, *TINY),
        beside=sent(BESIDE),
        later=sent(BESIDE, AGAIN, NEXT),
        welcome=[*sent(*range(len(first))), *third, *last],
        bad=[one for one in second if one not in last],
        last=last,
        canceled=third or ([first[LONG_ALONE]] if asked_again else [first[LONG], *later]),
        ended_for_another=older,
        sent=sent,
        longest=longest,
    )


def _compared(sent: SentGoal, longest: list[int]) -> ComparedGoal:
    order = int((sent.request or {}).get("order", -1))
    numbers, partials, due = _numbers(sent), _partials(sent), longest[: max(0, order + 1)]
    # Order 0 is a single number, but a server may also return both numbers with which it begins.
    fault = sent.objection(numbers == due or (order == 0 and numbers == longest[:2]), str(numbers))
    slip = _slip(partials, due)
    missing = (
        slip or _missing(partials, due) or ("" if was_computed(sent) else "the goal did not come to its end")
    )
    return ComparedGoal(
        **vars(sent),
        due=due,
        fault=fault,
        slip=slip and f"{sent}: {slip}",
        feedback_fault=missing and f"{sent}: {missing}",
        is_wrong_when_large=bool(fault) and len(due) > SMALL and numbers[:SMALL] == due[:SMALL],
    )


def was_computed(sent: SentGoal) -> bool:
    """Return True if the server came to the end of its work; one that hangs or raises on its way did not."""
    return sent.status == SUCCEEDED or (sent.status is not None and bool(_numbers(sent)))


def _slip(partials: Sequence[list[int]], due: list[int]) -> str:
    for place, partial in enumerate(partials):
        count = len(partials[0]) + place
        if len(partial) != count or partial != due[:count]:
            return ", ".join(map(str, partials[max(0, place - 1) : place + 1]))
    return ""


def _missing(partials: Sequence[list[int]], due: list[int]) -> str:
    if not partials:
        return "no feedback" if len(due) > 2 else ""
    # Feedback may begin with or before the first new number. Only the result must have the last one.
    is_whole = len(partials[0]) <= LONG_BEGINNING and len(partials[-1]) >= len(due) - 1
    return "" if is_whole else f"only from {len(partials[0])} to {len(partials[-1])} numbers"


def _numbers(sent: SentGoal) -> list[int]:
    return list(sent.result.get("sequence", []))


def _partials(sent: SentGoal) -> list[list[int]]:
    return [list(fields["partial_sequence"]) for fields in sent.feedback]
