r"""Make text that a student's program produced safe and legible to show.

A subject may log anything: colour codes, bidirectional overrides that turn a line around, a megabyte on one
line. What is shown must be what was said, so nothing is dropped silently: it is written out as an escape that
a Python programmer knows (``\x1b``), or cut in the middle with a mark.
"""

from __future__ import annotations

import functools
import json
import unicodedata

import re2

# What ends a colour or style in a terminal; carries no text (ECMA-48, "SGR").
_COLOUR_CODE = re2.compile(r"\x1b\[[0-9;:]*m")

# Joiners shape Persian words and family emoji; the other format characters are invisible or reorder a line.
_HARMLESS_FORMAT = frozenset("\u200c\u200d\u00ad")

_NAMED_ESCAPES = {"\n": "\\n", "\r": "\\r", "\t": "\\t"}


def printable(text: str) -> str:
    """``text`` with whatever could forge a line or move the cursor shown as an escape; of any length."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def printable_json(text: str) -> str:
    """Return JSON in which what would move a cursor or turn a line around is escaped; it reads back the same.

    Args:
        text: JSON on one line.
    """
    return "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in text)


def one_line(text: str, limit: int, *, mark: str = "…") -> str:
    """``text`` on one line, every control character written as an escape, cut in the middle to ``limit``.

    Args:
        text: Anything; lone surrogates and NUL included.
        limit: The most characters to return, the mark included.
        mark: What stands for the part that was cut out.
    """
    # Escaping can only lengthen: cutting first keeps a megabyte from being walked character by character.
    text = _cut(text, 4 * limit, mark)
    # Whatever would be escaped is not printable (Python's "isprintable"), and hardly any text has some of it.
    return _cut(text if text.isprintable() else "".join(map(_escaped, text)), limit, mark)


def paragraph(text: str, limit: int, *, mark: str = "…") -> str:
    """``text`` as one paragraph: runs of white space become one blank, the rest is as in `one_line`."""
    return one_line(" ".join(_cut(text, 8 * limit, mark).split()), limit, mark=mark)


def block(text: str, *, max_lines: int, max_columns: int, mark: str = "…") -> list[str]:
    """The lines of a traceback or of program output, colour codes removed, other control characters escaped.

    The first third and the last two thirds are kept when there are more than ``max_lines``: a traceback says
    the most at its end.
    """
    lines = _COLOUR_CODE.sub("", text).replace("\r\n", "\n").strip("\n").split("\n")
    if len(lines) > max_lines:
        head = max_lines // 3
        tail = max_lines - head - 1
        left_out = len(lines) - head - tail
        lines = [*lines[:head], f"{mark} {left_out} lines left out {mark}", *lines[-tail:]]
    return [one_line(line.expandtabs(4), max_columns, mark=mark).rstrip() for line in lines]


def width(text: str) -> int:
    """Columns that ``text`` takes in a fixed-width font: East Asian characters take two, accents none."""
    return len(text) if text.isascii() else sum(map(_columns, text))


def wrap(text: str, limit: int, first: str = "", later: str = "") -> list[str]:
    """Break one line into lines of at most ``limit`` columns, at blanks where there are any.

    Args:
        text: A line without control characters.
        limit: Columns, the indent included; the indents must leave room for a wide character.
        first: The indent of the first line.
        later: The indent of all others.
    """
    lines = []
    line, taken, empty = first, width(first), True
    for word in text.split():
        needed = width(word)
        if not empty and taken + 1 + needed > limit:
            lines.append(line)
            line, taken, empty = later, width(later), True
        if not empty:
            line, taken = line + " ", taken + 1
        if taken + needed <= limit:
            line, taken = line + word, taken + needed
            empty = False
            continue
        for character in word:
            if taken + _columns(character) > limit:
                lines.append(line)
                line, taken = later, width(later)
            line, taken = line + character, taken + _columns(character)
        empty = False
    return [*lines, line.rstrip() if empty else line]


@functools.lru_cache(maxsize=4096)
def _columns(character: str) -> int:
    if unicodedata.combining(character) or unicodedata.category(character) in {"Cf", "Mn", "Me"}:
        return 0
    return 2 if unicodedata.east_asian_width(character) in {"W", "F"} else 1


def _escaped(character: str) -> str:
    if character in _NAMED_ESCAPES:
        return _NAMED_ESCAPES[character]
    if character in _HARMLESS_FORMAT or not _is_invisible(character):
        return character
    code = ord(character)
    if code <= 0xFF:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"


def _is_invisible(character: str) -> bool:
    """True if it is a control, a format character, half a surrogate pair, a line separator or none at all."""
    code = ord(character)
    if code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF:
        return True
    return unicodedata.category(character) in {"Cc", "Cf", "Cs", "Zl", "Zp"}


def _cut(text: str, limit: int, mark: str) -> str:
    if len(text) <= limit:
        return text
    kept = max(limit - len(mark), 2)
    tail = kept // 2
    return text[: kept - tail] + mark + text[-tail:]
