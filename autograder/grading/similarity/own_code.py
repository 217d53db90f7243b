"""A student's own part of an answer: neither the task's text, nor its solution, nor what many wrote."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

from autograder.grading.similarity.words import Word, chosen_names, neutral, words

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from autograder.grading.similarity.student_texts import Answer

SEQUENCE = 7
"""As many words in a row are looked for: about one short line."""
LONGEST = 10_000
"""Words of an answer that are compared, more than a thousand lines."""
_LONGEST_TEXT = 20 * LONGEST
_MANY, _MANY_SHARE = 5, 0.25
"""Code that so many students have, and so large a share of all, counts as common."""

Sequence_ = tuple[str, ...]


@dataclass(frozen=True)
class Compared:
    """An answer, ready to be compared.

    Attributes:
        answer: The answer.
        code: Its words.
        signs: The same words, chosen names and texts made equal.
        own: For each word, whether it is the student's own.
        is_cut: Whether there is more, which is not compared.
        sequences: The sequences of words that are not the task's.
    """

    answer: Answer
    code: Sequence[Word]
    signs: Sequence[str]
    own: Sequence[bool]
    is_cut: bool
    sequences: frozenset[Sequence_]

    @property
    def length(self) -> int:
        """The number of the student's own words."""
        return sum(self.own)


class Given:
    """The texts that students have been given, and those of solutions.

    Args:
        texts: The cells of all sources and of all that was handed out.
    """

    def __init__(self, texts: Iterable[str]) -> None:
        cells = [list(words(text)) for text in texts]
        self.names = {name for cell in cells for name in chosen_names(cell)}
        self.texts = {word.text for cell in cells for word in cell if word.kind == "string"}
        self.sequences = {
            sequence for cell in cells for sequence in _sequences(neutral(cell, self.names, self.texts))
        }


def compared(answers: Sequence[Answer], given: Given, students: int) -> list[Compared]:
    """Find what is the students' own in their answers to one notebook.

    Args:
        answers: All answers to that notebook.
        given: The texts that belong to the task.
        students: The number of students who have handed it in.
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
