"""The pairs of answers that are closer than the task explains, also where something was put between or moved."""

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
"""Own words that two answers must share, four to eight lines. Of the right answers in the bank, which solve one task in
many ways, two that were not made one from the other share 27 at most."""
LEAST_SHARE = 0.5
"""Of the own words of the shorter answer, what must be shared."""
_ROUNDS = 6
"""The number of times that the rest is compared again: each time, one more order of moved blocks is found."""
_FOUND_IN_ONE, _FOUND_IN_OTHER = -3, -4

HINT = (
    "A pair is a hint, not a proof: two students may have learnt from each other, or from one page on the web. "
    "Read both answers, and talk with both, before you decide anything."
)
"""Said wherever pairs are shown."""


@dataclass(frozen=True)
class Passage:
    """Words that are in both answers in the same order.

    Attributes:
        first: The place of the first word in one answer.
        second: Its place in the other.
        own: For each word, whether it counts: it is the writer's own in both answers.
    """

    first: int
    second: int
    own: tuple[bool, ...]


@dataclass(frozen=True)
class Pair:
    """Two answers that are close.

    Attributes:
        one: One of them.
        other: The other.
        passages: The passages that they share, in the order of the first.
    """

    one: Compared
    other: Compared
    passages: Sequence[Passage]

    @property
    def shared(self) -> int:
        """The number of own words in these passages."""
        return sum(sum(passage.own) for passage in self.passages)

    @property
    def share(self) -> float:
        """The shared part of the own words of that answer which has fewer of them."""
        return self.shared / min(self.one.length, self.other.length)

    @property
    def percent(self) -> str:
        """The share in words; rounded down, so that 100 % is all of it."""
        return f"{int(100 * self.share)} %"

    @property
    def students(self) -> tuple[str, str]:
        """The ids of the two students."""
        return self.one.answer.student, self.other.answer.student

    @property
    def place(self) -> str:
        """The notebook and cell that it is in."""
        cells = dict.fromkeys((self.one.answer.cell, self.other.answer.cell))
        return f"{self.one.answer.notebook}, {' and '.join(cells)}"


def close_pairs(answers: Sequence[Compared]) -> list[Pair]:
    """The pairs of answers to one notebook that are close, the closest first.

    Any cell is compared with any of another student: an answer may have been moved into a cell of one's own.
    """
    candidates = _candidates([answer for answer in answers if answer.length >= SHORTEST])
    pairs = [Pair(left, right, _common_passages(left, right)) for left, right in candidates]
    return closest_first([pair for pair in pairs if pair.shared >= SHORTEST and pair.share >= LEAST_SHARE])


def closest_first(pairs: Sequence[Pair]) -> list[Pair]:
    """Pairs in the order in which they are shown."""
    return sorted(pairs, key=lambda pair: (-round(pair.share, 2), -pair.shared, _names(pair)))


def by_students(pairs: Iterable[Pair]) -> list[list[Pair]]:
    """Return the pairs of answers of each two students together, in the order in which they come first."""
    found: dict[tuple[str, str], list[Pair]] = {}
    for pair in pairs:
        found.setdefault(pair.students, []).append(pair)
    return list(found.values())


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


def _common_passages(one: Compared, other: Compared) -> list[Passage]:
    """The passages of two answers in the order of the first; each has at least a word that is its writer's own."""
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
            # What was found is not found again: no word of the other has this number.
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
    """The sentence for a class without a close pair."""
    return f"No pair is closer than the task explains ({compared} notebooks compared)."
