"""What a listener's lines say: which texts it heard, what it made up, what it said more than once."""

from __future__ import annotations

from collections import Counter
from difflib import SequenceMatcher
from typing import TYPE_CHECKING

import re2

from autograder.kit.evidence import spoken_by

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.evidence import Event, Part

_QUOTED = re2.compile(r"[\"“«].*[\pL\pN_].*[\"”»]")
_BYTE = ("\\x00", "\0")
"""A zero byte, as Python shows it or as it is. A serialized text has them before and behind it."""
MUCH = 5
"""Characters in a row of a text that a line has in it only if it was made of that text."""
OFTEN = 3
"""Times that a text is said before that alone is too often."""


def tells(line: str, text: str) -> bool:
    """Whether a line says a text: as it came, and not among the bytes of a serialized message."""
    before, found, after = line.partition(text)
    return bool(found) and not before.endswith(_BYTE) and not after.startswith(_BYTE)


def is_said(text: str, part: Part, *, after: Event | None = None) -> bool:
    """Whether the subject said a text, perhaps only after an event."""
    return any(tells(line, text) for line in part.said(after=after))


def has_much_of(line: str, text: str) -> bool:
    """Whether a line has a part of a text in it that no line has by chance, in capitals or not."""
    if tells(line, text) or any(byte in line for byte in _BYTE):
        return False
    found = SequenceMatcher(None, line.lower(), text.lower(), autojunk=False).find_longest_match()
    return found.size >= MUCH


def invented(part: Part, sent: Sequence[str]) -> list[str]:
    """What it claims to have heard although nobody sent it.

    Its own way of saying is learnt from the first line that carries a sent text: what stands before and after the text.
    A line with the same frame and another text in it was invented. Where it said none of the texts, a line with a
    quoted text is taken for such a claim.
    """
    spoken = part.said()
    lines = [line for line in spoken if not any(text in line for text in sent)]
    frames = {_frame(line, text) for text in sent if (line := _claim(spoken, text)) is not None}
    if not frames:
        return [] if part.traceback else [line for line in lines if _QUOTED.search(line)]
    return [
        line
        for line in lines
        for before, after in frames
        if len(before.strip()) > 3 and line.startswith(before) and line.endswith(after)
    ]


def repeated(part: Part, sent: Sequence[str]) -> dict[str, int]:
    """Texts that were sent once and said more than once in the same words and in the same way, and how often.

    A log line and a printed one are two ways, and so are two loggers. Only the words count in which a text is said
    first: a line of another kind may name it again.
    """
    channels: dict[tuple[str, ...], Counter[str]] = {}
    for channel, line in _by_channel(part):
        channels.setdefault(channel, Counter())[line] += 1
    often: dict[str, int] = {}
    for text in sent:
        first = _claim(part.said(), text)
        if first is not None:
            often[text] = max(lines[first] for lines in channels.values())
    many = {text: times for text, times in often.items() if times > 1}
    # A single line may come twice by chance, as where a program says what it has just said once more at its end.
    return many if len(many) > 1 or max(many.values(), default=0) >= OFTEN else {}


def _claim(lines: Sequence[str], text: str) -> str | None:
    """The line in which a text is said first."""
    return next((line for line in lines if tells(line, text)), None)


def _by_channel(part: Part) -> Iterator[tuple[tuple[str, ...], str]]:
    for event in part.events:
        line = spoken_by(event)
        if line is not None:
            logged = str(event.data.get("text", "")) != line
            yield (event.kind, event.name, str(event.data.get("level", "")), str(logged)), line


def _frame(line: str, text: str) -> tuple[str, str]:
    before, _, after = line.partition(text)
    return before, after
