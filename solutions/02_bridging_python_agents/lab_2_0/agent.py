"""Lab 2.0, an agent without ROS: what a new one decides for one observation after the other."""

from itertools import pairwise
from random import Random

from autograder.kit import Returns, dealt, drawn_until, levels, mixed

NEAR, FREE = 0.6, 1.0
"""A turn begins below the first distance in meters, and ends above the second, which every float holds."""
BEGIN, DRIVE_ON = [*levels(NEAR)[:4], 0.5], [*levels(NEAR)[4:], 0.9]
TURN_ON, END = [*levels(FREE)[:4], 0.5, FREE], levels(FREE)[4:]
"""The walls ahead at which a turn begins, an agent drives on, a turn goes on, and a turn ends."""
SIDES = ((2.0, 1.4), (0.9, 0.5), (1.4, 2.0), (0.5, 0.9), (1.0, 1.0))
"""The room on the left and on the right, at the beginning of each turn."""


def observations(random: Random) -> list[list[float]]:
    """Return what an agent sees that begins five turns and ends four. While it turns, another side has more room.

    The first wall says nothing to a new agent, and tells one that still turns.
    """
    cycles = zip(
        dealt(random, [*DRIVE_ON, *random.sample(DRIVE_ON, random.randint(2, 4))], 5),
        random.sample(BEGIN, 5),
        mixed(random, SIDES, lambda sides: sides[0] > sides[1]),
        [*dealt(random, [*TURN_ON, *random.sample(TURN_ON, 2)], 4), []],
        [*([end] for end in random.sample(END, 4)), []],
        strict=True,
    )
    seen: list[list[float]] = []
    for drive_on, begin, (left, right), turn_on, end in cycles:
        seen += [[ahead, *random.choice(SIDES)] for ahead in drive_on]
        other = [2.0, 1.4] if left == right else [right, left]
        seen += [[begin, left, right], *([ahead, *other] for ahead in (*turn_on, *end))]
    return seen


def tells(seen: list[list[float]]) -> bool:
    """Return True if a new agent drives first, and a turn meets a second near wall with more room on the other side."""
    again = (
        one[0] < NEAR > two[0] and (one[1] - one[2]) * (two[1] - two[2]) < 0 for one, two in pairwise(seen)
    )
    return NEAR < seen[0][0] < FREE and any(again)


EXERCISE = Returns(
    "lab_2_0.agent",
    "Lab 2.0 · An agent that explores",
    "Return the command for each observation: drive ahead, and turn away in front of a wall.",
    gives=lambda random: drawn_until(lambda: observations(random), tells),
).exercise(
    text={
        "If it turns, and the wall ahead is farther than 1 meter, it stops turning.": "returned",
        "nearer than 0.6 meters, it begins to turn": "returned",
        "`Command(turn=self.turn)` while it turns": "returned",
    }
)
