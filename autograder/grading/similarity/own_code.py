"""Finds a student's own part of an answer: not from the task or its solution, and not what many students wrote."""

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
"""The length of the sequences that are compared, in words: about one short line."""
LONGEST = 10_000
"""The maximum number of words of an answer that are compared: more than a thousand lines."""
_LONGEST_TEXT = 20 * LONGEST
_MANY, _MANY_SHARE = 5, 0.25
"""Code counts as common if at least this number of students, and at least this fraction of all students, have it."""

Sequence_ = tuple[str, ...]


@dataclass(frozen=True)
class Compared:
    """An answer, prepared for the comparison.

    Attributes:
        answer: The answer.
        code: The words of the answer.
        signs: The same words, but with names and texts that the student chose replaced by one sign each.
        own: For each word, True if it is the student's own.
        is_cut: True if the answer is longer than the compared part.
        sequences: The sequences of words that do not come from the task.
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
    """The texts that students received, and the solutions.

    Args:
        texts: The cells of all sources and of everything that was handed out.
    """

    def __init__(self, texts: Iterable[str]) -> None:
        cells = [list(words(text)) for text in texts]
        self.names = {name for cell in cells for name in chosen_names(cell)}
        self.texts = {word.text for cell in cells for word in cell if word.kind == "string"}
        self.sequences = {
            sequence for cell in cells for sequence in _sequences(neutral(cell, self.names, self.texts))
        }


def compared(answers: Sequence[StudentAnswer], given: GivenTexts, students: int) -> list[Compared]:
    """Return the answers to one notebook, each with the student's own part marked.

    Args:
        answers: All answers to that notebook.
        given: The texts that belong to the task.
        students: The number of students who handed in the notebook.
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
