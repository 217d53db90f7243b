"""Words for drawing inputs, so that each drawing alone tells right from wrong: levels around a limit, and an order.

A subject that counts its inputs, or whose limit is not that of the task, must fail in each drawing. So the order of
the cases is drawn, and the inputs near a limit are the levels of a ladder: no two usual numbers have the same levels
below them.
"""

from __future__ import annotations

from itertools import pairwise, product
from math import inf
from random import Random  # noqa: TC003  (an author reads the types)
from typing import TYPE_CHECKING, TypeVar

from autograder.kit.oracle.steps import To
from autograder.robot.sensors import RAYS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

T = TypeVar("T")
LADDER = (0.3, 0.65, 0.85, 0.98, 1.02, 1.18, 1.37, 1.75)
"""The levels of a limit, as its multiples. Between two of them lies at most one limit that students write by mistake,
such as half of the right one, nine tenths or one and a quarter. None is the limit itself, because a number such as 0.8
arrives as 0.80000001 in a field of the type float32.
"""
TRIES = 10_000
"""The number of drawings after which what is asked of a drawing counts as impossible."""


def levels(limit: float, below: float = inf) -> list[float]:
    """Return the levels around a limit, from the lowest to the highest.

    Args:
        limit: The number with which the task compares. At 0 there are no levels: draw small numbers on both sides.
        below: Only levels below this number are possible, such as the width of a room.
    """
    return [level for factor in LADDER if (level := round(limit * factor, 4)) < below]


def drawn_until(draw: Callable[[], T], tells: Callable[[T], bool]) -> T:
    """Draw again until a drawing tells what it has to. Return that drawing.

    Raises:
        ValueError: No drawing of many did.
    """
    drawings = (draw() for _ in range(TRIES))
    for drawn in drawings:
        if tells(drawn):
            return drawn
    raise ValueError(f"gives: none of {TRIES} drawings tells what it has to")


def shuffled(random: Random, cases: Sequence[T]) -> list[T]:
    """Return the cases in drawn order."""
    return random.sample(cases, len(cases))


def mixed(random: Random, cases: Sequence[T], kind: Callable[[T], object]) -> list[T]:
    """Return the cases in a drawn order in which each kind follows each kind, itself too.

    Two kinds need five cases, such as three of one and two of the other; three kinds need ten: four, three and three.

    Raises:
        ValueError: There is no such order, because there are too few cases.
    """
    pairs = {*product({kind(case) for case in cases}, repeat=2)}
    return drawn_until(lambda: shuffled(random, cases), lambda order: {*pairwise(map(kind, order))} >= pairs)


def dealt(random: Random, cases: Sequence[T], hands: int) -> list[list[T]]:
    """Return the cases in drawn order, dealt to a number of hands. No hand is empty if there are enough cases."""
    order = shuffled(random, cases)
    first = list(range(hands))
    of = first + [random.randrange(hands) for _ in order[hands:]]
    return [[case for case, hand in zip(order, of, strict=False) if hand == one] for one in first]


def scan(random: Random, limit: float, ahead: float, around: str = "", stands: float = 0.0) -> To:
    """Return a laser scan with a wall ahead, and levels of the same limit all around.

    Args:
        random: What draws.
        limit: The distance in meters with which the task compares the wall ahead.
        ahead: The distance in meters of the wall ahead.
        around: ``"far"`` or ``"near"`` if all other rays are on that side of the limit; by default they are drawn.
        stands: See :class:`autograder.kit.oracle.steps.To`.
    """
    sides = {"far": (limit, inf), "near": (0.0, limit)}
    low, high = sides.get(around, (0.0, inf))
    possible = [level for level in levels(limit) if low < level < high]
    return To("/scan", {"ranges": [ahead, *random.choices(possible, k=RAYS - 1)]}, stands)


def scans(random: Random, limit: float, aheads: Sequence[float]) -> list[To]:
    """Return a scan for each distance ahead, in the given order.

    If there are at least two distances on each side of the limit, a node that looks in any other direction, or at the
    nearest or farthest wall, is wrong: everything around is far once while the wall ahead is near, and the reverse.
    """
    near, far = ([n for n, ahead in enumerate(aheads) if (ahead < limit) is side] for side in (True, False))
    around = dict.fromkeys(random.sample(near, len(near) // 2), "far")
    around |= dict.fromkeys(random.sample(far, len(far) // 2), "near")
    around |= dict.fromkeys(random.sample([n for n in far if n not in around], len(far) // 4), "far")
    return [scan(random, limit, ahead, around.get(n, "")) for n, ahead in enumerate(aheads)]
