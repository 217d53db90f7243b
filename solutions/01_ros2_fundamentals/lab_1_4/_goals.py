"""The goals that Lab 1.4 sends to an action server, and what is wrong about how one ended."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from autograder.kit.goals_seen import SUCCEEDED, Goal, goal, status_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Evidence, Part

GOALS = "goals"
BAD_ORDERS = "bad orders"
ORDERS = (5, 4, 3)
"""Orders of the goal alone and of the smaller one of two at once; the seed decides."""
LONGER = 14
"""The order of the larger one of two at once: more numbers than a server would have that stops after a while."""
SMALLEST = ((1, 0, 1), (0, 1, 1, 1), (1, 0, 1))
"""Orders that take no time, in batches: the edge of what there is, and enough goals for a server that dies of many."""
SINGLE = 0
"""The order of a single number. A server may also answer it with both numbers that it begins with."""
LAST_ORDER = 2
"""The order of the goal after the bad ones."""
NO_TIME = 0.005
"""Seconds between two feedback messages that no pause makes: the shortest that a person would write is twice as long,
and in a notebook none is made shorter than that."""
HURRIED = 0.25
"""The share of such short intervals from which on a server is taken not to pause."""
FIRST_TOO_LARGE = 47
"""The first order whose last number does not fit into an int32."""
ALONE, FIRST_OF_TWO, SECOND_OF_TWO = range(3)
TINY = range(3, 3 + sum(map(len, SMALLEST)))
LONG = TINY.stop
"""The goals of the first part by their numbers. In the second part the last one is good, those before it are bad."""
LONG_ORDER = 46
"""The order of the goal that is canceled: the largest that there is."""


def takes_no_time(part: Part) -> bool:
    """Whether the server counts without any pause between two numbers.

    Such a goal is over before anybody can cancel it, except where the machine happens to be so busy that the request
    gets in between. A busy machine makes intervals longer and never shorter, and no server that pauses between two
    numbers can send two of them at once. So it is the short intervals that tell, however few they are; a pause that
    makes up for an earlier one (a rate's) is allowed for.
    """
    pauses = sorted(pause for number in (*PACED, LONG) for pause in goal(part, number).pauses)
    return bool(pauses) and pauses[int(len(pauses) * HURRIED)] < NO_TIME


PACED = (ALONE, FIRST_OF_TWO, SECOND_OF_TWO)
"""The goals that take time and are to succeed."""


def paced_goals(evidence: Evidence) -> list[Goal]:
    """The goals that take time and are to succeed, as far as they were sent."""
    return _sent(evidence, PACED)


def good_goals(evidence: Evidence) -> list[Goal]:
    """All goals that are to succeed, as far as they were sent."""
    return _sent(evidence, (*PACED, *TINY))


def _sent(evidence: Evidence, numbers: Sequence[int]) -> list[Goal]:
    known = [goal(evidence.part(GOALS), number) for number in numbers]
    return [seen for seen in known if seen.order is not None]


def expected_sequence(evidence: Evidence, order: int) -> list[int]:
    """What the reference solution answers to one of the orders."""
    known = [goal(evidence.reference.part(GOALS), number) for number in PACED]
    longest = max((seen.sequence for seen in known), key=len)
    extra = len(known[0].sequence) - int(known[0].order or 0)
    return longest[: order + extra]


def objection(evidence: Evidence, seen: Goal) -> str:
    """What is wrong about how a good goal ended, in words; empty where it is right."""
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


def feedback_objection(evidence: Evidence, seen: Goal) -> str:
    """What is wrong about the feedback of a good goal; empty where it grows by one number each time."""
    wanted = expected_sequence(evidence, int(seen.order or 0))
    where = f"order {seen.order}: "
    if not seen.feedback:
        return f"{where}no feedback"
    if text := feedback_slip(evidence, seen):
        return text
    # It may begin before or with the first new number, and need not tell the last one, which the result does.
    whole = len(seen.feedback[0]) <= 3 and len(seen.feedback[-1]) >= len(wanted) - 1
    if whole and not seen.was_computed:
        return f"{where}the goal did not come to its end"
    return "" if whole else where + _first_messages(seen)


def feedback_slip(evidence: Evidence, seen: Goal) -> str:
    """What is wrong about the feedback messages that came, however many are missing before or after them."""
    wanted = expected_sequence(evidence, int(seen.order or 0))
    grows = all(len(after) == len(before) + 1 for before, after in pairwise(seen.feedback))
    right = all(partial == wanted[: len(partial)] for partial in seen.feedback)
    return "" if grows and right else f"order {seen.order}: {_first_messages(seen)}"


def _first_messages(seen: Goal) -> str:
    return ", ".join(map(str, seen.feedback[:4]))


def is_beginning(numbers: Sequence[int], start: Sequence[int]) -> bool:
    """Whether the numbers go on from ``start`` as the sequence does."""
    return list(numbers[:2]) == list(start[: len(numbers[:2])]) and all(
        c == a + b for a, b, c in zip(numbers, numbers[1:], numbers[2:], strict=False)
    )


def first_two(evidence: Evidence) -> list[int]:
    """What the sequence begins with."""
    return expected_sequence(evidence, min(ORDERS))[:2]
