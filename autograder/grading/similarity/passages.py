"""The passages that two answers have in common, also where something was put between or moved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rapidfuzz.distance import LCSseq

from autograder.grading.similarity.own_code import SEQUENCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.grading.similarity.own_code import Compared

_ROUNDS = 6
"""The number of times that the rest is compared again: each time, one more order of moved blocks is found."""
_FOUND_IN_FIRST, _FOUND_IN_SECOND = -3, -4


@dataclass(frozen=True)
class Passage:
    """Words that are in both answers in the same order.

    Attributes:
        first: The place of the first word in one answer.
        second: Its place in the other.
        length: How many words.
    """

    first: int
    second: int
    length: int


def common_passages(one: Compared, other: Compared) -> list[Passage]:
    """The passages of two answers, in the order of the first; each has at least a word that is its writer's own."""
    numbers = {sign: number for number, sign in enumerate({*one.signs, *other.signs})}
    first, second = ([numbers[sign] for sign in signs] for signs in (one.signs, other.signs))
    found: list[Passage] = []
    for _ in range(_ROUNDS):
        passages = _aligned(first, second)
        for passage in passages:
            # What was found is not found again: no word of the other has this number.
            first[passage.first : passage.first + passage.length] = [_FOUND_IN_FIRST] * passage.length
            second[passage.second : passage.second + passage.length] = [_FOUND_IN_SECOND] * passage.length
        found += passages
        if not passages:
            break
    return sorted(
        (passage for passage in found if any(own_words(one, other, passage))),
        key=lambda passage: passage.first,
    )


def own_words(one: Compared, other: Compared, passage: Passage) -> list[bool]:
    """For each word of a passage, whether it counts: it is the writer's own in both answers."""
    return [
        one.own[passage.first + step] and other.own[passage.second + step] for step in range(passage.length)
    ]


def _aligned(first: Sequence[int], second: Sequence[int]) -> list[Passage]:
    blocks = LCSseq.opcodes(first, second)
    return [
        Passage(block.src_start, block.dest_start, block.src_end - block.src_start)
        for block in blocks
        if block.tag == "equal" and block.src_end - block.src_start >= SEQUENCE
    ]
