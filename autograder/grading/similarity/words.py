"""An answer as words that survive what is changed to hide a copy: comments, layout, the names that one may choose.

Nothing is parsed, since a student's text need not be Python, and need not be meant well: one pass of an expression that
takes no more time than the text is long.
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
    """A piece of code that counts.

    Attributes:
        kind: ``name``, ``string``, ``number`` or ``sign``.
        text: As it was written.
        start: The place of its first character in the text.
        end: The place behind its last one.
        opens: Whether it is the first of a line.
    """

    kind: str
    text: str
    start: int
    end: int
    opens: bool


def words(text: str) -> Iterator[Word]:
    """The words of a text, without comments, docstrings and the first line of a cell that writes a file."""
    before = 0
    for match in _WORD.finditer(text):
        kind = match.lastgroup or "sign"
        if kind not in ("comment", "docstring"):
            opens = before == 0 or "\n" in text[before : match.start()]
            yield Word(kind, match.group(), match.start(), match.end(), opens)
        before = match.end()


def chosen_names(code: Sequence[Word]) -> set[str]:
    """The names that the writer has chosen: of variables, functions, classes, parameters and attributes."""
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
            # One that has a type, or is the first of several: x: int = 3, self.x: int = 3, x, y = 3, 4
            first = code[place - 2] if before == "." else word
            is_declared = behind in (":", ",") and first.opens
            is_assigned = (depth == 0 and (behind == "=" or is_declared)) or behind == ":="
            if before in _BEFORE_A_NEW_NAME or is_parameter or is_assigned or in_loop:
                chosen.add(word.text)
    return chosen


def neutral(code: Sequence[Word], names: Collection[str], texts: Collection[str]) -> list[str]:
    """The words with one sign for every name that somebody has chosen, and one for every text that is not the task's.

    Args:
        code: The words of an answer.
        names: Names that somebody has chosen.
        texts: The texts that the task has.
    """
    return [
        _CHOSEN_NAME
        if word.kind == "name" and word.text in names
        else _CHOSEN_TEXT
        if word.kind == "string" and word.text not in texts
        else word.text
        for word in code
    ]
