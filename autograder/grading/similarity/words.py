"""Splits code into words for the comparison, without comments, layout and chosen names, which often differ in copies.

A regular expression reads the text, in time proportional to its length. Python's parser cannot be used, because a
student's text may be invalid or hostile.
"""

from __future__ import annotations

import builtins
import keyword
from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

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
    for place, word in enumerate(code):
        before = code[place - 1].text if place else ""
        behind = code[place + 1].text if place + 1 < len(code) else ""
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
            first = code[place - 2] if before == "." else word
            is_declared = behind in (":", ",") and first.opens
            is_assigned = (depth == 0 and (behind == "=" or is_declared)) or behind == ":="
            if before in _BEFORE_A_NEW_NAME or is_parameter or is_assigned or in_loop:
                chosen.add(word.text)
    return chosen


def neutral(code: Sequence[Word], names: Collection[str], texts: Collection[str]) -> list[str]:
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
