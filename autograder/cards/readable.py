r"""Makes text from a student's program safe and legible to show.

A subject may log anything: color codes, bidirectional overrides that reverse a line, a megabyte on one line. A card
must show what the program really printed, so nothing is dropped silently. A special character is written as an escape
that a Python programmer knows (``\x1b``). A long text is cut in the middle, with a mark.
"""

from __future__ import annotations

import functools
import json
import unicodedata

import re2

# Matches a code that sets a color or style in a terminal and contains no text (ECMA-48, "SGR").
_COLOUR_CODE = re2.compile(r"\x1b\[[0-9;:]*m")

# The format characters that are kept: joiners shape Persian words and family emoji. All other format characters are
# invisible or reorder a line.
_HARMLESS_FORMAT = frozenset("\u200c\u200d\u00ad")

_NAMED_ESCAPES = {"\n": "\\n", "\r": "\\r", "\t": "\\t"}


def printable(text: str) -> str:
    """Return ``text`` with escapes for characters that are not printable, such as newlines and terminal codes."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def printable_json(text: str) -> str:
    """Return equivalent JSON in which characters that are not printable, such as terminal codes, are escaped.

    Args:
        text: JSON on a single line.
    """
    return "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in text)


def one_line(text: str, limit: int, *, mark: str = "…") -> str:
    """Return ``text`` on one line, with control characters as escapes, cut in the middle to ``limit`` characters.

    Args:
        text: Any text; it may contain lone surrogates and NUL.
        limit: The maximum length of the result in characters, including the mark.
        mark: The text that stands for the part that was cut out.
    """
    # Cut first, because escaping makes a text only longer, and escaping a megabyte would take long.
    text = _cut(text, 4 * limit, mark)
    # Most texts are printable in Python's sense, and then contain no character that needs escaping.
    return _cut(text if text.isprintable() else "".join(map(_escaped, text)), limit, mark)


def paragraph(text: str, limit: int, *, mark: str = "…") -> str:
    """Return ``text`` as one paragraph: each run of whitespace becomes a space; otherwise as in `one_line`."""
    return one_line(" ".join(_cut(text, 8 * limit, mark).split()), limit, mark=mark)


def block(text: str, *, max_lines: int, max_columns: int, mark: str = "…") -> list[str]:
    """Return the lines of a traceback or of output without color codes, and with other control characters escaped.

    If there are more than ``max_lines`` lines, some of the first and twice as many of the last are kept, because a
    traceback says the most at its end.
    """
    lines = _COLOUR_CODE.sub("", text).replace("\r\n", "\n").strip("\n").split("\n")
    if len(lines) > max_lines:
        head = max_lines // 3
        tail = max_lines - head - 1
        left_out = len(lines) - head - tail
        lines = [*lines[:head], f"{mark} {left_out} lines left out {mark}", *lines[-tail:]]
    return [one_line(line.expandtabs(4), max_columns, mark=mark).rstrip() for line in lines]


def width(text: str) -> int:
    """Return the width of ``text`` in columns of a fixed-width font. East Asian characters take two, accents none."""
    return len(text) if text.isascii() else sum(map(_columns, text))


def wrap(text: str, limit: int, first: str = "", later: str = "") -> list[str]:
    """Break one line into lines of at most ``limit`` columns, at spaces if possible.

    Args:
        text: A line without control characters.
        limit: The maximum width in columns, including the indent. The indents must leave space for a wide character.
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
    """Return True for control and format characters, surrogates, line separators and unassigned characters."""
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
