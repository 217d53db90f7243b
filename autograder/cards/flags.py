"""The places of a lane's labels: no label covers another, and no leader runs through one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards import readable

if TYPE_CHECKING:
    from collections.abc import Sequence

CHARACTER = 6.7
"""Pixels of one character of the 11-pixel monospaced label font; a lane's name is set one pixel larger."""
MANY = 8
"""Moments in a lane beyond which the labels that may be left out stay on one level: a calm lane."""
LEVELS = 4


@dataclass(frozen=True)
class Wish:
    """A label that wants a place: its text, the mark's x in pixels, and whether it may not be left out."""

    label: str
    x: float
    needed: bool = False


@dataclass(frozen=True)
class Flag:
    """A label in its place: a leader ``level`` rows high at ``pole``, text from ``left`` to ``right``."""

    level: int
    pole: float
    left: float
    right: float

    def clear_of(self, other: Flag) -> bool:
        """True if the two texts do not touch and neither leader runs through the other's text."""
        if self.level == other.level:
            return self.right + 4 <= other.left or other.right + 4 <= self.left
        upper, lower = (self, other) if self.level > other.level else (other, self)
        return not (lower.left < upper.pole <= lower.right + 2) or upper.pole == lower.pole


def length(label: str) -> float:
    """Pixels from a mark to the end of its label."""
    return 5 + readable.width(label) * CHARACTER


def flags(wishes: Sequence[Wish]) -> list[Flag | None]:
    """Give each label of a lane, in order of x, a place, or None where there is none.

    From right to left: an earlier label then rises above the later ones and its leader crosses none of them. So a
    place can always be found for those that are needed, which come first.
    """
    many = len(wishes) > MANY
    found: list[Flag | None] = [None] * len(wishes)
    placed: list[Flag] = []
    for needed in (True, False):
        for index in reversed(range(len(wishes))):
            wish = wishes[index]
            if not wish.label or wish.needed is not needed:
                continue
            # The first one gets a row of its own where it needs it: the others continue its words.
            levels = len(wishes) + 1 if needed else (1 if many else LEVELS) + (index == 0)
            before = wishes[index - 1].x if index else 0.0
            flag = _place(wish, levels, placed, free_left=0.0 if many else wish.x - before)
            if flag:
                placed.append(flag)
                found[index] = flag
    return found


def _place(wish: Wish, levels: int, placed: Sequence[Flag], *, free_left: float) -> Flag | None:
    """The lowest free place right of the mark, else the lowest within ``free_left`` pixels left of it."""
    x, long = wish.x, length(wish.label)
    for left in (x, x - long) if long < free_left and not wish.needed else (x,):
        for level in range(levels):
            flag = Flag(level, x, left, left + long)
            if all(flag.clear_of(other) for other in placed):
                return flag
    return None
