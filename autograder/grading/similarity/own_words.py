"""Splits answers into words, and marks the words that are a student's own.

A word is not the student's own if it is from the task, the solution, or the answers of many other students. Comments,
layout and chosen names are left out, because they often differ in copies.

A regular expression reads the text, in time proportional to its length. Python's parser cannot be used, because a
student's text may be invalid or hostile.
"""

from __future__ import annotations

import builtins
import keyword
from collections import defaultdict
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from autograder.grading.similarity.student_answers import StudentAnswer


SEQUENCE = 7
"""The number of words in each of the sequences by which answers are compared; about one short line of code."""
LONGEST = 10_000
"""The maximum number of words of an answer to compare. Even an answer of a thousand lines has fewer words."""
_LONGEST_TEXT = 20 * LONGEST
_MANY, _MANY_SHARE = 5, 0.25
"""A sequence is not a student's own if at least this number and this fraction of the students wrote it."""

_WordSequence = tuple[str, ...]


@dataclass(frozen=True)
class ComparedAnswer:
    """An answer, prepared for the comparison.

    Attributes:
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
    sequences: frozenset[_WordSequence]

    @property
    def length(self) -> int:
        """The number of the student's own words."""
        return sum(self.own)


class GivenCode:
    """The code that is not a student's own: code that students received, and the solutions.

    Args:
        texts: The texts of the code cells in all source notebooks and released notebooks.
    """

    def __init__(self, texts: Iterable[str]) -> None:
        cells = [list(words(text)) for text in texts]
        self.names = {name for cell in cells for name in chosen_names(cell)}
        self.texts = {word.text for cell in cells for word in cell if word.kind == "string"}
        self.sequences = {
            sequence for cell in cells for sequence in _sequences(neutral_words(cell, self.names, self.texts))
        }


def compared_answers(
    answers: Sequence[StudentAnswer], given: GivenCode, students: int
) -> list[ComparedAnswer]:
    """Return the answers to one notebook, prepared for the comparison.

    Args:
        answers: All students' answers to the notebook.
        given: The code that is not a student's own.
        students: The number of students who submitted the notebook.
    """
    longer = [list(islice(words(answer.text[:_LONGEST_TEXT]), LONGEST + 1)) for answer in answers]
    codes = [code[:LONGEST] for code in longer]
    # Renaming must not hide a copy: names that a student chose become placeholders in all answers of that student.
    names: defaultdict[str, set[str]] = defaultdict(lambda: set(given.names))
    for answer, code in zip(answers, codes, strict=True):
        names[answer.student] |= chosen_names(code)
    signs = [
        neutral_words(code, names[answer.student], given.texts)
        for answer, code in zip(answers, codes, strict=True)
    ]
    holders: defaultdict[_WordSequence, set[str]] = defaultdict(set)
    for answer, own_signs in zip(answers, signs, strict=True):
        for sequence in _sequences(own_signs):
            holders[sequence].add(answer.student)
    # A sequence that many students wrote is the usual way to write it, and not a hint of copying.
    many = max(_MANY, _MANY_SHARE * students)
    common = {sequence for sequence, who in holders.items() if len(who) >= many} | given.sequences
    return [
        ComparedAnswer(
            answer,
            code,
            own_signs,
            _own(own_signs, common),
            len(every) > LONGEST or len(answer.text) > _LONGEST_TEXT,
            frozenset(_sequences(own_signs)) - common,
        )
        for answer, every, code, own_signs in zip(answers, longer, codes, signs, strict=True)
    ]


def _own(signs: Sequence[str], common: set[_WordSequence]) -> list[bool]:
    own = [True] * len(signs)
    for index, sequence in enumerate(_sequences(signs)):
        if sequence in common:
            own[index : index + SEQUENCE] = [False] * SEQUENCE
    return own


def _sequences(signs: Sequence[str]) -> Iterator[_WordSequence]:
    return (tuple(signs[index : index + SEQUENCE]) for index in range(len(signs) - SEQUENCE + 1))


_WORD = re2.compile(
    r"(?ms)(?P<comment>#[^\n]*|^%%?[a-z]+[^\n]*)"
    r'|(?P<docstring>[rRbBuUfF]{0,2}(?:"""(?:[^"\\]|\\.|"[^"]|""[^"])*"""|\'\'\'(?:[^\'\\]|\\.|\'[^\']|\'\'[^\'])*\'\'\'))'
    r'|(?P<string>[rRbBuUfF]{0,2}(?:"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)*\'))'
    r"|(?P<name>[\pL_][\pL\pN_]*)"
    r"|(?P<number>\d[\w.]*)"
    r"|(?P<sign>:=|==|!=|<=|>=|->|\*\*|//|[-+*/%&|^]=|[^\s])"
)
_FIXED = frozenset(keyword.kwlist) | frozenset(dir(builtins)) | {"self"}
_CHOSEN_NAME, _CHOSEN_TEXT = "a name", "a text"
_BEFORE_A_NEW_NAME = frozenset({"def", "class", "as"})
_OPENING, _CLOSING = frozenset("([{"), frozenset(")]}")


@dataclass(frozen=True)
class Word:
    """A word of code: a name, a text, a number or a sign such as ``+=``.

    Attributes:
        kind: ``name``, ``string``, ``number`` or ``sign``.
        text: The original text.
        start: The index of the word's first character in the text.
        end: The index after the word's last character.
        opens: True if the word is the first in its line.
    """

    kind: str
    text: str
    start: int
    end: int
    opens: bool


def words(text: str) -> Iterator[Word]:
    """Yield the words of code. Comments, docstrings and lines with a magic are left out."""
    before = 0
    for match in _WORD.finditer(text):
        kind = match.lastgroup or "sign"
        if kind not in ("comment", "docstring"):
            opens = before == 0 or "\n" in text[before : match.start()]
            yield Word(kind, match.group(), match.start(), match.end(), opens)
        before = match.end()


def chosen_names(code: Sequence[Word]) -> set[str]:
    """Return the names that code defines: of variables, functions, classes, parameters and attributes."""
    chosen: set[str] = set()
    depth, in_head, in_loop = 0, False, False
    for index, word in enumerate(code):
        before = code[index - 1].text if index else ""
        behind = code[index + 1].text if index + 1 < len(code) else ""
        if word.text in _OPENING:
            depth += 1
        elif word.text in _CLOSING:
            depth = max(0, depth - 1)
            in_head = in_head and depth > 0
        elif word.text == "def":
            depth, in_head = 0, True
        elif word.text in ("for", "in"):
            in_loop = word.text == "for"
        elif word.kind == "name" and word.text not in _FIXED:
            is_parameter = in_head and depth == 1 and before in ("(", ",", "*", "**")
            # The code defines the name x in the lines x: int = 3, self.x: int = 3, and x, y = 3, 4.
            first = code[index - 2] if before == "." else word
            is_declared = behind in (":", ",") and first.opens
            is_assigned = (depth == 0 and (behind == "=" or is_declared)) or behind == ":="
            if before in _BEFORE_A_NEW_NAME or is_parameter or is_assigned or in_loop:
                chosen.add(word.text)
    return chosen


def neutral_words(code: Sequence[Word], names: Collection[str], texts: Collection[str]) -> list[str]:
    """Return the texts of words, with one sign for every chosen name, and another for every chosen string.

    Args:
        code: The words of an answer.
        names: The chosen names, which are all replaced by the same sign.
        texts: The strings that the task contains. All other strings are replaced by the same sign.
    """
    return [
        _CHOSEN_NAME
        if word.kind == "name" and word.text in names
        else _CHOSEN_TEXT
        if word.kind == "string" and word.text not in texts
        else word.text
        for word in code
    ]
