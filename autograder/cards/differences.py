"""Compares two texts that should be equal, and marks what is missing and what is too much."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.verdict import CriterionResult

ALIKE = 0.5
"""The minimum similarity of two texts, from 0 to 1. If they are less similar, showing their difference would not help.
"""
LONGEST = 120
"""The maximum length of a compared text, in characters, because the time grows with the square of the length."""
_QUOTED = re2.compile("“([^“”]*)”")
_BLANK = "␣"
_PLACE = "N"
"""The letter that stands for any whole number in an expected text."""


class DiffTag(StrEnum):
    """The kind of a piece of text: equal, missing, or too much."""

    SAME = "same"
    MISSING = "missing"
    EXTRA = "extra"


@dataclass(frozen=True)
class TextPiece:
    """A sequence of characters, all equal in both texts, all missing, or all too much."""

    kind: DiffTag
    text: str

    @property
    def marked(self) -> str:
        """Return the text with marks that show its kind without color: ``[missing]``, ``{too much}``."""
        if self.kind is DiffTag.SAME:
            return self.text
        text = self.text.replace(" ", _BLANK)
        return f"[{text}]" if self.kind is DiffTag.MISSING else f"{{{text}}}"


def difference(criterion: CriterionResult) -> tuple[TextPiece, ...]:
    """Return the difference between the first quoted text that was seen and the first one that was expected.

    The result is empty if the criterion is met or if one side has no quoted text. It is also empty if the two texts are
    equal, too long, or too different for a comparison to help.
    """
    if criterion.passed:
        return ()
    expected, seen = _QUOTED.search(criterion.expected), _QUOTED.search(criterion.seen)
    if expected is None or seen is None:
        return ()
    return _pieces(expected[1], seen[1])


def marked(pieces: Iterable[TextPiece]) -> str:
    """Return all pieces as one text, with brackets around what is missing: ``"Hello[,] world[!] 0"``."""
    return "".join(piece.marked for piece in pieces)


def _pieces(expected: str, seen: str) -> tuple[TextPiece, ...]:
    if expected == seen or max(len(expected), len(seen)) > LONGEST:
        return ()
    matcher = difflib.SequenceMatcher(None, expected, seen, autojunk=False)
    if matcher.ratio() < ALIKE:
        return ()
    found = []
    for operation, a1, a2, b1, b2 in matcher.get_opcodes():
        fills_in = expected[a1:a2] == _PLACE and seen[b1:b2].isdigit()
        if operation == "equal" or fills_in:
            found.append(TextPiece(DiffTag.SAME, seen[b1:b2]))
            continue
        if operation in ("delete", "replace"):
            found.append(TextPiece(DiffTag.MISSING, expected[a1:a2]))
        if operation in ("insert", "replace"):
            found.append(TextPiece(DiffTag.EXTRA, seen[b1:b2]))
    return tuple(found)
