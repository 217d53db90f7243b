"""The goals that Lab 1.4 sends to an action server, and what is wrong about how one ended."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

from autograder.kit import outcomes
from autograder.kit.outcomes import ABORTED, CANCELED, SUCCEEDED, Goal, status_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Evidence, Part

GOALS = "goals"
BAD_ORDERS = "bad orders"
CANCELED_ALONE = "a goal alone is canceled"
"""The run that is made only if two goals at once have ended the server before it was asked to cancel one."""
ORDERS = (5, 4)
"""Orders of the goal alone, which is sent again after the cancel; the seed decides. Either has enough numbers to show
feedback that leaves some out."""
LARGE_ORDER = 37
"""The order of the goal that goes on beside the others. Its last numbers fit neither into 16 bits nor into the 24 of a
short float, and are not those of the golden ratio with a few digits."""
SMALLEST = (1, 0, 1, 0, 1, 1, 1, 1, 0, 1)
"""Orders that take no time, one after another: the edge of what there is, and enough for a server that dies of many."""
SINGLE = 0
"""The order of a single number. A server may also answer it with both numbers that it begins with."""
LAST_ORDER = 2
"""The order of the two goals after the bad ones, and of two equal ones that are sent at once."""
SMALL = 20
"""Numbers of that goal after which the others that run beside it are over."""
NEXT_ORDER = 3
"""The order of the goal that is sent as soon as the server has agreed to cancel the one before it."""
NO_TIME = 0.009
"""Seconds between two feedback messages that no pause makes: the shortest that a person would write is longer, and in a
notebook none is made shorter than that. Two goals that never pause take turns of Python's 0.005 s."""
HURRIED, HURRIED_ALONE = 0.25, 0.5
"""The share of such short intervals from which on a server is taken not to pause: of all, and of the few of those goals
that do not compete with another one where none takes time."""
LONG_SILENCE, BURST = 1.0, 0.1
"""Seconds of work without feedback, and the share of them in which all feedback comes if it is sent at the end."""
ROUNDS_LEFT = 2
"""Numbers that a server may still compute after it agreed to cancel: in its present round, and in the next one if it
checked too early.
"""
FIRST_TOO_LARGE = 47
"""The first order whose last number does not fit into an int32."""
ALONE = 0
TINY = range(1, 1 + len(SMALLEST))
TWINS = range(TINY.stop, TINY.stop + 2)
LONG, BESIDE, AGAIN, LONG_ALONE, NEXT, YOUNGER = range(TWINS.stop, TWINS.stop + 6)
"""The goals of the first part by their numbers. In the second part the last two are good, those before them are bad."""
LONG_ORDER = 46
"""The order of the goals that are canceled: the largest that there is."""
LONG_BEGINNING = 3
"""Numbers that the first feedback of a goal has at most: the two that it begins with, and a new one."""
PACED = (ALONE, BESIDE, AGAIN)
"""The goals that take time and are to succeed."""
PACED_ALONE = (ALONE, AGAIN)
"""The goals among them that have the server to themselves."""


@dataclass(frozen=True)
class FibonacciGoal(Goal):
    """A goal, with the fields of its action by name."""

    @property
    def order(self) -> int | None:
        """The requested order; None if the goal was not sent."""
        return None if self.request is None else int(self.request["order"])

    @property
    def partials(self) -> list[list[int]]:
        """The partial sequences of the feedback, in order."""
        return [list(fields["partial_sequence"]) for fields in self.feedback]

    @property
    def sequence(self) -> list[int]:
        """The numbers of the result."""
        return list(self.result.get("sequence", []))

    @property
    def grows(self) -> bool:
        """True if each feedback message has one number more than the message before."""
        return all(len(after) == len(before) + 1 for before, after in pairwise(self.partials))

    @property
    def told_before(self) -> int:
        """The numbers in the last feedback before the cancel request."""
        return len(self.partials[self.before_cancel - 1]) if self.before_cancel else 0

    @property
    def was_computed(self) -> bool:
        """True if the server came to the end of its work; one that hangs or raises on its way did not."""
        return self.status == SUCCEEDED or (self.status is not None and bool(self.sequence))


def goal(part: Part, number: int) -> FibonacciGoal:
    """The goal of that number."""
    return FibonacciGoal(**vars(outcomes.goal(part, number)))


def all_goals(part: Part) -> list[FibonacciGoal]:
    """All goals that were sent."""
    return [FibonacciGoal(**vars(one)) for one in outcomes.all_goals(part)]


def ended_by_a_younger(part: Part) -> FibonacciGoal | None:
    """Return the goal that the server ended for a newer one, before a cancel was requested; None if there is none.

    A server may do so, like the official example of a single goal.
    """
    older, younger = goal(part, LONG), goal(part, BESIDE)
    if older.status not in (ABORTED, CANCELED) or not younger.accepted:
        return None
    about_both = [e for e in part.events if e.data.get("goal") in (LONG, BESIDE)]
    end = next(e for e in about_both if e.kind == "result_heard" and e.data["goal"] == LONG)
    before = [e.kind for e in about_both[: about_both.index(end)]]
    return older if before.count("goal_sent") == 2 and "cancel_sent" not in before else None


def to_be_canceled(evidence: Evidence) -> FibonacciGoal:
    """Return the goal that is canceled: next to a newer one, or alone if the server ended it for that one."""
    part, alone = evidence.part(GOALS), evidence.part(CANCELED_ALONE)
    if alone.events:
        return goal(alone, LONG_ALONE)
    return goal(part, LONG_ALONE if ended_by_a_younger(part) else LONG)


def canceled_later(part: Part) -> list[FibonacciGoal]:
    """The goals that were canceled after the first one: one beside an older goal, and one to which a new goal came."""
    sent = [goal(part, number) for number in (YOUNGER, LONG_ALONE)]
    return [] if ended_by_a_younger(part) else [seen for seen in sent if seen.accepted]


def before_any_cancel(part: Part) -> Part:
    """The events before the judge asked to cancel a goal."""
    kinds = [event.kind for event in part.events]
    return replace(part, events=part.events[: kinds.index("cancel_sent")]) if "cancel_sent" in kinds else part


def died_of_two(part: Part) -> bool:
    """True if the server ended with an exception when two goals were sent at once."""
    seen = before_any_cancel(part)
    two_at_once = goal(seen, TWINS[0]).order is not None
    return two_at_once and seen.ending is not None and bool(seen.traceback)


def takes_no_time(part: Part) -> bool:
    """True if the server counts without any pause between two numbers.

    Such a goal is over before it can be canceled, except if the machine happens to be so busy that the request
    gets in between. A busy machine makes intervals longer and never shorter, and no server that pauses between two
    numbers can send two of them at once. So it is the short intervals that tell, however few they are; a pause that
    makes up for an earlier one (a rate's) is allowed for.
    """
    shares = ((HURRIED, (*PACED, LONG)), (HURRIED_ALONE, (ALONE, AGAIN)))
    return any(_hurries(part, *share) for share in shares) and not tells_at_the_end(part)


def _hurries(part: Part, share: float, numbers: Sequence[int]) -> bool:
    pauses = sorted(pause for number in numbers for pause in goal(part, number).pauses)
    return bool(pauses) and pauses[int(len(pauses) * share)] < NO_TIME


def tells_at_the_end(part: Part) -> bool:
    """True if the server works in silence, and sends all feedback at once when it is done."""
    return all(is_told_at_the_end(goal(part, number)) for number in (ALONE, BESIDE))


def is_told_at_the_end(seen: FibonacciGoal) -> bool:
    """True if all feedback of a goal was sent at once, after seconds of work."""
    if not seen.pauses or seen.answered_at is None:
        return False
    silent = seen.sent[0] - seen.answered_at
    return silent >= LONG_SILENCE and sum(seen.pauses) < BURST * silent


def paced_goals(evidence: Evidence) -> list[FibonacciGoal]:
    """The goals that take time and are to succeed, as far as they were sent."""
    return _sent(evidence, PACED)


def good_goals(evidence: Evidence) -> list[FibonacciGoal]:
    """All goals that are to succeed, as far as they were sent."""
    return _sent(evidence, (*PACED, *TINY))


def goals_alone(evidence: Evidence) -> list[FibonacciGoal]:
    """All goals that are to succeed and have the server to themselves, as far as they were sent."""
    return _sent(evidence, (*PACED_ALONE, *TINY))


def paced_goals_alone(evidence: Evidence) -> list[FibonacciGoal]:
    """Return the goals among them that take time."""
    return _sent(evidence, PACED_ALONE)


def _sent(evidence: Evidence, numbers: Sequence[int]) -> list[FibonacciGoal]:
    part = evidence.part(GOALS)
    older, beside = goal(part, LONG), goal(part, BESIDE)
    one_at_a_time = older.accepted and (
        beside.accepted is False or (beside.accepted is None and not older.over)
    )
    known = {number: goal(part, number) for number in numbers}
    # Whether a server takes a goal while it works on another one is a question of its own.
    return [
        seen
        for number, seen in known.items()
        if seen.order is not None and not (number == BESIDE and one_at_a_time)
    ]


def expected_sequence(evidence: Evidence, order: int) -> list[int]:
    """The reference solution's answer to one of the orders."""
    known = [goal(evidence.reference.part(GOALS), number) for number in PACED]
    longest = max((seen.sequence for seen in known), key=len)
    extra = len(known[0].sequence) - int(known[0].order or 0)
    return longest[: order + extra]


def objection(evidence: Evidence, seen: FibonacciGoal) -> str:
    """Return the fault in the end of a good goal, in words; empty if it is right."""
    order = int(seen.order or 0)
    wanted = [expected_sequence(evidence, order)]
    where = f"order {seen.order}: "
    if order == SINGLE:
        wanted.append(first_two(evidence))
    if seen.accepted is None:
        return f"{where}the goal was not answered"
    if not seen.accepted:
        return f"{where}the goal was rejected"
    if seen.status is None:
        return f"{where}no result"
    if seen.status != SUCCEEDED:
        return f"{where}status {status_text(seen.status)}"
    return "" if seen.sequence in wanted else f"{where}{seen.sequence}"


def feedback_objection(evidence: Evidence, seen: FibonacciGoal) -> str:
    """Return the fault in the feedback of a good goal, in words; empty if it grows by one number each time."""
    wanted = expected_sequence(evidence, int(seen.order or 0))
    where = f"order {seen.order}: "
    if not seen.partials:
        return f"{where}no feedback"
    if text := feedback_slip(evidence, seen):
        return text
    # Feedback may begin before or with the first new number, and need not contain the last one, which the result has.
    whole = len(seen.partials[0]) <= LONG_BEGINNING and len(seen.partials[-1]) >= len(wanted) - 1
    if whole and not seen.was_computed:
        return f"{where}the goal did not come to its end"
    return "" if whole else where + _first_messages(seen)


def feedback_slip(evidence: Evidence, seen: FibonacciGoal) -> str:
    """The fault in the feedback messages that came, in words, however many are missing before or after them."""
    wanted = expected_sequence(evidence, int(seen.order or 0))
    last = seen.partials[-1] if seen.partials else []
    if len(last) > len(wanted):
        return f"order {seen.order}: the last feedback, {last}, has {len(last)} numbers; the sequence has {len(wanted)}"
    right = all(partial == wanted[: len(partial)] for partial in seen.partials)
    return "" if seen.grows and right else f"order {seen.order}: {_first_messages(seen)}"


def _first_messages(seen: FibonacciGoal) -> str:
    return ", ".join(map(str, seen.partials[:4]))


def is_wrong_when_large(evidence: Evidence, seen: FibonacciGoal) -> bool:
    """True if a goal is right as long as another one may run beside it, and its large numbers are wrong."""
    wanted = expected_sequence(evidence, int(seen.order or 0))
    right_so_far = len(wanted) > SMALL and seen.sequence[:SMALL] == wanted[:SMALL]
    return seen.status == SUCCEEDED and right_so_far and seen.sequence != wanted


def is_beginning(numbers: Sequence[int], start: Sequence[int]) -> bool:
    """True if the numbers go on from ``start`` as the sequence does."""
    return list(numbers[:2]) == list(start[: len(numbers[:2])]) and all(
        c == a + b for a, b, c in zip(numbers, numbers[1:], numbers[2:], strict=False)
    )


def first_two(evidence: Evidence) -> list[int]:
    """The numbers with which the sequence begins."""
    return expected_sequence(evidence, min(ORDERS))[:2]
