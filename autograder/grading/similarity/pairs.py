"""The pairs of answers that are closer than the task explains."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from autograder.grading.similarity.own_code import SEQUENCE
from autograder.grading.similarity.passages import Passage, common_passages, own_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.grading.similarity.own_code import Compared

SHORTEST = 40
"""Own words that two answers must share, four to eight lines. Of the right answers in the bank, which solve one task in
many ways, two that were not made one from the other share 27 at most."""
LEAST_SHARE = 0.5
"""Of the own words of the shorter answer, what must be shared."""


HINT = (
    "A pair is a hint, not a proof: two students may have learnt from each other, or from one page on the web. "
    "Read both answers, and talk with both, before you decide anything."
)
"""Said wherever pairs are shown."""


@dataclass(frozen=True)
class Pair:
    """Two answers that are close.

    Attributes:
        one: One of them.
        other: The other.
        passages: What they have in common.
        shared: Own words in these passages.
    """

    one: Compared
    other: Compared
    passages: Sequence[Passage]
    shared: int

    @property
    def share(self) -> float:
        """The shared part of the own words of that answer which has fewer of them."""
        return self.shared / min(self.one.length, self.other.length)

    @property
    def percent(self) -> str:
        """The share in words; rounded down, so that 100 % is all of it."""
        return f"{int(100 * self.share)} %"

    @property
    def place(self) -> str:
        """In which notebook and cell it is."""
        cells = dict.fromkeys((self.one.answer.cell, self.other.answer.cell))
        return f"{self.one.answer.notebook}, {' and '.join(cells)}"


def close_pairs(answers: Sequence[Compared]) -> list[Pair]:
    """The pairs of answers to one notebook that are close, the closest first.

    Any cell is compared with any of another student: an answer may have been moved into a cell of one's own.
    """
    pairs = []
    for left, right in _candidates([answer for answer in answers if answer.length >= SHORTEST]):
        passages = common_passages(left, right)
        shared = sum(sum(own_words(left, right, passage)) for passage in passages)
        if shared < SHORTEST:
            continue
        pair = Pair(left, right, passages, shared)
        if pair.share >= LEAST_SHARE:
            pairs.append(pair)
    return closest_first(pairs)


def closest_first(pairs: Sequence[Pair]) -> list[Pair]:
    """Pairs in the order in which they are shown."""
    return sorted(pairs, key=lambda pair: (-round(pair.share, 2), -pair.shared, _names(pair)))


def _candidates(answers: Sequence[Compared]) -> list[tuple[Compared, Compared]]:
    """The pairs with sequences enough in common for a finding; to lay all answers side by side would take long.

    In a passage, at least every seventh of the shared own words begins a sequence, or is in one, that is shared.
    """
    holders: defaultdict[tuple[str, ...], list[int]] = defaultdict(list)
    for place, answer in enumerate(answers):
        for sequence in answer.sequences:
            holders[sequence].append(place)
    meetings = Counter(pair for places in holders.values() for pair in combinations(places, 2))
    return [
        (answers[left], answers[right])
        for (left, right), sequences in sorted(meetings.items())
        if sequences >= SHORTEST // SEQUENCE and answers[left].answer.student != answers[right].answer.student
    ]


def _names(pair: Pair) -> tuple[str, ...]:
    return (
        pair.one.answer.assignment,
        pair.one.answer.student,
        pair.other.answer.student,
        pair.one.answer.cell,
    )


def nothing_found(compared: int) -> str:
    """What is said where no pair is close."""
    return f"No pair is closer than the task explains ({compared} notebooks compared)."
