"""Marks the words of an answer that are a student's own: not from the task, its solution, or many other students."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

from autograder.grading.similarity.words import Word, chosen_names, neutral, words

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from autograder.grading.similarity.student_texts import StudentAnswer

SEQUENCE = 7
"""The number of words in each of the sequences by which answers are compared; about one short line of code."""
LONGEST = 10_000
"""The maximum number of words of an answer to compare. Even an answer of a thousand lines has fewer words."""
_LONGEST_TEXT = 20 * LONGEST
_MANY, _MANY_SHARE = 5, 0.25
"""A sequence is not a student's own if at least this number and this fraction of the students wrote it."""

Sequence_ = tuple[str, ...]


@dataclass(frozen=True)
class Compared:
    """An answer, prepared for the comparison.

    Attributes:
        answer: The answer.
        code: The words of the answer.
        signs: The words for the comparison: all names that the student chose are replaced by one sign, and all texts
            that the student chose by another.
        own: For each word, True if the word is the student's own.
        is_cut: True if the answer is too long, so that only its beginning is compared.
        sequences: The sequences of words that are the student's own.
    """

    answer: StudentAnswer
    code: Sequence[Word]
    signs: Sequence[str]
    own: Sequence[bool]
    is_cut: bool
    sequences: frozenset[Sequence_]

    @property
    def length(self) -> int:
        """The number of the student's own words."""
        return sum(self.own)


class GivenTexts:
    """The code that is not a student's own: code that students received, and the solutions.

    Args:
        texts: The texts of the code cells in all source notebooks and released notebooks.
    """

    def __init__(self, texts: Iterable[str]) -> None:
        cells = [list(words(text)) for text in texts]
        self.names = {name for cell in cells for name in chosen_names(cell)}
        self.texts = {word.text for cell in cells for word in cell if word.kind == "string"}
        self.sequences = {
            sequence for cell in cells for sequence in _sequences(neutral(cell, self.names, self.texts))
        }


def compared(answers: Sequence[StudentAnswer], given: GivenTexts, students: int) -> list[Compared]:
    """Return the answers to one notebook, prepared for the comparison.

    Args:
        answers: All students' answers to the notebook.
        given: The code that is not a student's own.
        students: The number of students who submitted the notebook.
    """
    longer = [list(islice(words(answer.text[:_LONGEST_TEXT]), LONGEST + 1)) for answer in answers]
    codes = [code[:LONGEST] for code in longer]
    names: defaultdict[str, set[str]] = defaultdict(lambda: set(given.names))
    for answer, code in zip(answers, codes, strict=True):
        names[answer.student] |= chosen_names(code)
    signs = [
        neutral(code, names[answer.student], given.texts) for answer, code in zip(answers, codes, strict=True)
    ]
    holders: defaultdict[Sequence_, set[str]] = defaultdict(set)
    for answer, own_signs in zip(answers, signs, strict=True):
        for sequence in _sequences(own_signs):
            holders[sequence].add(answer.student)
    many = max(_MANY, _MANY_SHARE * students)
    common = {sequence for sequence, who in holders.items() if len(who) >= many} | given.sequences
    return [
        Compared(
            answer,
            code,
            own_signs,
            _own(own_signs, common),
            len(every) > LONGEST or len(answer.text) > _LONGEST_TEXT,
            frozenset(_sequences(own_signs)) - common,
        )
        for answer, every, code, own_signs in zip(answers, longer, codes, signs, strict=True)
    ]


def _own(signs: Sequence[str], common: set[Sequence_]) -> list[bool]:
    own = [True] * len(signs)
    for place, sequence in enumerate(_sequences(signs)):
        if sequence in common:
            own[place : place + SEQUENCE] = [False] * SEQUENCE
    return own


def _sequences(signs: Sequence[str]) -> Iterator[Sequence_]:
    return (tuple(signs[place : place + SEQUENCE]) for place in range(len(signs) - SEQUENCE + 1))
