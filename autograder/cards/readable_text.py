r"""Makes text from a student's program safe and legible to show, and finds the student's line in a traceback.

A program may log anything: color codes, bidirectional overrides that reverse a line, a megabyte on one line. A card
must show what the program really printed, so nothing is dropped silently. A special character is written as an escape
that a Python programmer knows (``\x1b``). A long text is cut in the middle, with a mark.
"""

from __future__ import annotations

import functools
import unicodedata
from dataclasses import dataclass

import re2

# Matches a code that sets a color or style in a terminal and contains no text (ECMA-48, "SGR").
_COLOR_CODE = re2.compile(r"\x1b\[[0-9;:]*m")

# The format characters that are kept: joiners shape Persian words and family emoji. All other format characters are
# invisible or reorder a line.
_HARMLESS_FORMAT = frozenset("\u200c\u200d\u00ad")

_LONG_NUMBER = re2.compile(r"\b\d+\.\d{3,}\b")
_NAMED_ESCAPES = {"\n": "\\n", "\r": "\\r", "\t": "\\t"}


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


def label(text: str, limit: int, *, mark: str = "…") -> str:
    """Return the label of a message on one line, cut between its values: ``[1.18, 2.0, …, 0.94]``.

    If it is too long, numbers are rounded to two digits after the point first. A text without three values that are
    separated by commas is cut as in `one_line`.
    """
    if len(text) > limit:
        text = _LONG_NUMBER.sub(lambda number: f"{float(number[0]):.2f}", text)
        values = text.split(", ")
        for kept in range(len(values), 1, -1):
            head, tail = values[: (kept + 1) // 2], values[len(values) - kept // 2 :]
            shorter = ", ".join([*head, *([mark] if kept < len(values) else []), *tail])
            if len(shorter) <= limit:
                return one_line(shorter, limit, mark=mark)
    return one_line(text, limit, mark=mark)


def paragraph(text: str, limit: int, *, mark: str = "…") -> str:
    """Return ``text`` as one paragraph: each run of whitespace becomes a space; otherwise as in `one_line`."""
    return one_line(" ".join(_cut(text, 8 * limit, mark).split()), limit, mark=mark)


def block(text: str, *, max_lines: int, max_columns: int, mark: str = "…") -> list[str]:
    """Return the lines of a traceback or of output without color codes, and with other control characters escaped.

    If there are more than ``max_lines`` lines, some of the first and twice as many of the last are kept, because a
    traceback says the most at its end.
    """
    lines = _COLOR_CODE.sub("", text).replace("\r\n", "\n").strip("\n").split("\n")
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
        # The word is longer than a line, such as a path or a list without spaces, and has to be broken.
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


TRACEBACK = "Traceback (most recent call last)"
_FRAME = re2.compile(r'^ +File "(?P<file>[^"]*)", line (?P<line>\d+)(?:, in (?P<function>\w+))?')
_LIBRARIES = ("/site-packages/", "/lib/python3", "/opt/ros/", "<frozen")
_BUILT = re2.compile(r"/install/(?:[^/.]+/)?lib/python3[^/]*/site-packages/")
"""Matches the folder into which a build installs a workspace's modules, which the student wrote."""
_CALLED_BY_ROS = "/rclpy/task.py"
"""The file of rclpy that calls callbacks. A student's line above it in a traceback only calls ``spin`` and is not the
cause of the error.
"""
_CANNOT_BE_READ = ("SyntaxError", "IndentationError", "TabError")
"""Errors that have no traceback, because Python cannot start the program."""
_SCRIPT = re2.compile(r"/lib/[^/]+/[^/.]+$")
"""Matches the generated file of an entry point, which ``ros2 run`` starts and the student did not write."""
_CALLED_WITH = "Invoked with: "
_FORM_OF_CALL = re2.compile(r"\d+\. \(")
"""Matches a line with one of the signatures that an error of pybind11 lists."""
_CELL_FILES = ("/ipykernel_", "<ipython-input")


@dataclass(frozen=True)
class TracebackLine:
    """The student's line in which a program failed.

    Attributes:
        where: The position, such as ``"Line 11 of your cell"``, or the line of a file. If code of several cells led to
            it, the cells are named by their functions.
        quote: The text of the line without indentation; empty if unknown.
        error: The exception, such as ``"AttributeError: 'Talker' object has no attribute 'nmae'"``.
    """

    where: str
    quote: str
    error: str


def last_error(detail: str) -> str:
    """Return the last line that is not empty. If the text is a traceback, this is the exception."""
    lines = (line.strip() for line in reversed(detail.splitlines()) if not line.startswith(_CALLED_WITH))
    return next((line for line in lines if line and not _FORM_OF_CALL.match(line)), "")


def students_line(detail: str, advice: str = "") -> TracebackLine | None:
    """Return the last line of the student's own code in the last traceback of a text.

    Return None if there is no such line, or if the line only calls ``spin``: the mistake is then in a callback.

    Args:
        detail: The text with the traceback.
        advice: What the card says about it. A line that it quotes is returned rather than a later one, which may belong
            to a function that the student was given.
    """
    lines = detail.splitlines()
    error = last_error(detail)
    starts = [number for number, line in enumerate(lines) if line.startswith(TRACEBACK)]
    if not starts and error.startswith(_CANNOT_BE_READ):
        starts = [0]
    if not starts or error.startswith(TRACEBACK):
        return None
    found: tuple[re2.Match[str], str] | None = None
    caller: re2.Match[str] | None = None
    for number in range(starts[-1], len(lines)):
        frame = _FRAME.match(lines[number])
        if frame and _is_students(frame["file"]):
            after = lines[number + 1] if number + 1 < len(lines) else ""
            quote = after.strip() if after.startswith("    ") and not _FRAME.match(after) else ""
            if found is None or not found[1] or found[1] not in advice:
                caller = found[0] if found and found[0]["file"] != frame["file"] else caller
                found = (frame, quote)
        elif frame and _CALLED_BY_ROS in frame["file"]:
            # rclpy called what follows, so the line found so far only spins the node.
            found = caller = None
    if found is None:
        return None
    frame, quote = found
    cells = [one for one in (caller, frame) if one and _is_cell(one) and one["function"]]
    if caller is None or len(cells) < 2:
        return TracebackLine(f"Line {frame['line']} of {_place(frame)}", quote, error)
    called = f"called in line {caller['line']} of the cell with {caller['function']}"
    return TracebackLine(f"Line {frame['line']} of the cell with {frame['function']}, {called}", quote, error)


def _is_cell(frame: re2.Match[str]) -> bool:
    return any(part in frame["file"] for part in _CELL_FILES)


def _place(frame: re2.Match[str]) -> str:
    return "your cell" if _is_cell(frame) else frame["file"].rpartition("/")[2]


def _is_students(file: str) -> bool:
    of_a_library = any(part in file for part in _LIBRARIES) and not _BUILT.search(file)
    return not of_a_library and not _SCRIPT.search(file)
