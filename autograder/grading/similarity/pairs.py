"""Finds pairs of answers that are more similar than the task explains, even if lines were inserted or moved."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from rapidfuzz.distance import LCSseq

from autograder.grading.similarity.own_code import SEQUENCE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from autograder.grading.similarity.own_code import Compared

SHORTEST = 40
"""The minimum number of own words that two answers must share: four to eight lines.

For comparison: in the bank, which solves a task in many ways, two independent right answers share at most 27.
"""
LEAST_SHARE = 0.5
"""The minimum share of own words that the two have in common, as a fraction of the answer with fewer own words."""
_ROUNDS = 6
"""How many times two answers are compared, each time without the passages already found. One comparison finds passages
in the same order in both answers; the next ones find blocks that were moved.
"""
_FOUND_IN_ONE, _FOUND_IN_OTHER = -3, -4

HINT = (
    "A pair is a hint, not a proof: two students may have learnt from each other, or from one page on the web. "
    "Read both answers, and talk with both, before you decide anything."
)
"""The sentence that is shown with every list of pairs."""


@dataclass(frozen=True)
class Passage:
    """A sequence of words that two answers have in common, in the same order.

    Attributes:
        first: The index of its first word in the first answer.
        second: The index of its first word in the second answer.
        own: For each word, True if it is the student's own in both answers.
    """

    first: int
    second: int
    own: tuple[bool, ...]


@dataclass(frozen=True)
class Pair:
    """Two similar answers.

    Attributes:
        one: The first answer.
        other: The second answer.
        passages: The passages that they have in common, in the order of the first answer.
    """

    one: Compared
    other: Compared
    passages: Sequence[Passage]

    @property
    def shared(self) -> int:
        """The number of own words in the common passages."""
        return sum(sum(passage.own) for passage in self.passages)

    @property
    def share(self) -> float:
        """The number of shared own words, as a fraction of the own words of the answer that has fewer."""
        return self.shared / min(self.one.length, self.other.length)

    @property
    def percent(self) -> str:
        """Return the share in percent as text, rounded down, so that only complete agreement is 100 %."""
        return f"{int(100 * self.share)} %"

    @property
    def students(self) -> tuple[str, str]:
        """The ids of the two students."""
        return self.one.answer.student, self.other.answer.student

    @property
    def place(self) -> str:
        """Return the notebook and the cell of the answers, as text."""
        cells = dict.fromkeys((self.one.answer.cell, self.other.answer.cell))
        return f"{self.one.answer.notebook}, {' and '.join(cells)}"


def close_pairs(answers: Sequence[Compared]) -> list[Pair]:
    """Return the similar pairs of answers to one notebook, the closest first.

    Each cell is compared with every cell of another student, because an answer may have been moved into an added
    cell.
    """
    candidates = _candidates([answer for answer in answers if answer.length >= SHORTEST])
    pairs = [Pair(left, right, _common_passages(left, right)) for left, right in candidates]
    return closest_first([pair for pair in pairs if pair.shared >= SHORTEST and pair.share >= LEAST_SHARE])


def closest_first(pairs: Sequence[Pair]) -> list[Pair]:
    """Return the pairs in the order in which they are shown."""
    return sorted(pairs, key=lambda pair: (-round(pair.share, 2), -pair.shared, _names(pair)))


def by_students(pairs: Iterable[Pair]) -> list[list[Pair]]:
    """Return the pairs of answers grouped by their two students, in the order of the first pair of each group."""
    found: dict[tuple[str, str], list[Pair]] = {}
    for pair in pairs:
        found.setdefault(pair.students, []).append(pair)
    return list(found.values())


def _candidates(answers: Sequence[Compared]) -> list[tuple[Compared, Compared]]:
    """Return the pairs with enough common sequences to be worth comparing; comparing all pairs would take too long.

    In a common passage, at least every seventh of the shared words that the students wrote themselves is part of a
    common sequence, or begins one.
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


def _common_passages(one: Compared, other: Compared) -> list[Passage]:
    """Return the passages that two answers have in common, in the order of the first answer.

    Each passage contains at least one word that both students wrote themselves, and not only given code.
    """
    numbers = {sign: number for number, sign in enumerate({*one.signs, *other.signs})}
    first, second = ([numbers[sign] for sign in answer.signs] for answer in (one, other))
    found: list[Passage] = []
    for _ in range(_ROUNDS):
        blocks = [
            (block.src_start, block.dest_start, block.src_end - block.src_start)
            for block in LCSseq.opcodes(first, second)
            if block.tag == "equal" and block.src_end - block.src_start >= SEQUENCE
        ]
        if not blocks:
            break
        for here, there, length in blocks:
            # A passage is found only once, because the other answer contains no word with this number.
            first[here : here + length] = [_FOUND_IN_ONE] * length
            second[there : there + length] = [_FOUND_IN_OTHER] * length
            sides = zip(one.own[here : here + length], other.own[there : there + length], strict=True)
            found.append(Passage(here, there, tuple(left and right for left, right in sides)))
    return sorted((passage for passage in found if any(passage.own)), key=lambda passage: passage.first)


def _names(pair: Pair) -> tuple[str, ...]:
    return (
        pair.one.answer.assignment,
        pair.one.answer.student,
        pair.other.answer.student,
        pair.one.answer.cell,
    )


def nothing_found(compared: int) -> str:
    """Return the sentence for a class without similar pairs."""
    return f"No pair is closer than the task explains ({compared} notebooks compared)."
