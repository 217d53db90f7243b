"""Lines that a subject said: numbers in them, and a listener's texts, heard, made up, or said more than once."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import re2

from autograder.kit.evidence import spoken_by
from autograder.kit.model import Advice

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.evidence import Event, Part


_QUOTED = re2.compile(r"[\"“«].*[\pL\pN_].*[\"”»]")
_OPENING, _CLOSING = tuple("\"'“‘«`"), tuple("\"'”’»`")
_A_TALKERS = re2.compile(r"\W*[Hh]ello,? [Ww]orld!?\W*\d+\W*")
"""The texts of the talkers of this course and of the official tutorials."""
_TWO_WORDS = re2.compile(r"\b([a-z]+) ([a-z]+) \d{4}\b")
"""The special parts of the judge's texts, see :func:`autograder.kit.recipes.sent_texts.random_texts`."""
_BRACES = re2.compile(r"\{[\pL_][^{}]*\}")
"""The part of a text that an f-string would have filled in."""
_BYTE = ("\\x00", "\0")
"""A zero byte, as Python shows it or as it is. A serialized text has them before and behind it."""
MUCH = 5
"""Characters in a row of a text that a line has in it only if it was made of that text."""
OFTEN = 3
"""Times that the last text is said before that alone is too often."""
GROWING = 6
"""Lines in a row, each with all that came before, that are more than a look back at the last few texts."""


def tells(line: str, text: str) -> bool:
    """True if a line says a text: as it came, and not among the bytes of a serialized message."""
    found = _frame(line, text)
    return found is not None and not found.before.endswith(_BYTE) and not found.after.startswith(_BYTE)


def is_said(text: str, part: Part, *, after: Event | None = None) -> bool:
    """True if the subject said a text, perhaps only after an event."""
    return any(tells(line, text) for line in part.said(after=after))


def said_first_after(event: Event | None, part: Part) -> list[str]:
    """The lines that the subject said after an event and not before it; none where the event is missing.

    A log line comes twice, as output and on /rosout, and the second of the two may be slow.
    """
    if event is None:
        return []
    later, everything = part.said(after=event), part.said()
    before = everything[: len(everything) - len(later)]
    return [line for line in later if line not in before]


def not_filled_in(lines: Sequence[str]) -> Advice | None:
    """The advice for the first line with the name of a variable in braces: Python fills them only in an f-string."""
    line = next((line for line in lines if _BRACES.search(line)), None)
    if line is None:
        return None
    return Advice(
        f"Your program said “{line}”: Python did not fill in the braces, because there is no f in front of the string.",
        'Write f directly before the quotation mark: f"...". Python then puts the value where the braces are.',
    )


def has_much_of(line: str, text: str) -> bool:
    """True if a line has a part of a text in it that no line has by chance, in capitals or not."""
    if tells(line, text) or any(byte in line for byte in _BYTE):
        return False
    where, what = line.lower(), text.lower()
    return any(what[i : i + MUCH] in where for i in range(len(what) - MUCH + 1))


@dataclass(frozen=True)
class Frame:
    """The words in which a program says a text.

    Attributes:
        before: What is before the text in its line.
        after: What is behind it.
    """

    before: str
    after: str

    def content(self, line: str) -> str | None:
        """The part of a line in the place of the text; None where the line has other words."""
        long_enough = len(line) >= len(self.before) + len(self.after)
        if not (long_enough and line.startswith(self.before) and line.endswith(self.after)):
            return None
        return line[len(self.before) : len(line) - len(self.after)]

    @property
    def is_telling(self) -> bool:
        """True if it is too long for other lines to have it by chance."""
        return len(self.before.strip()) > 3

    @property
    def has_quotes(self) -> bool:
        """True if the text is in quotation marks."""
        return self.before.endswith(_OPENING) and self.after.startswith(_CLOSING)

    @property
    def quotes(self) -> bool:
        """True if the marks are there for the text alone, and not for each line, as in JSON or in ``msg="…"``."""
        rest = self.before[:-1]
        return self.has_quotes and not rest.endswith("=") and not any(mark in rest for mark in _OPENING)

    def is_claim(self, content: str) -> bool:
        """True if a line with this content claims to tell of a text.

        Many programs have their name at the front of each line, also of one that tells what they wait for. So what is
        not quoted is a claim only where it is what a talker says.
        """
        return self.quotes or (self.has_quotes and not content) or _A_TALKERS.fullmatch(content) is not None


def invented(part: Part, sent: Sequence[str]) -> list[str]:
    """The texts that it claims to have heard although nobody sent them.

    Its own way of saying is learnt from the first line that carries a sent text: what is before and after the text.
    A line with the same frame and another text in it was invented. Where it said none of the texts, a line with a
    quoted text is taken for such a claim.
    """
    found = _frames(part, sent)
    if not found:
        return [] if part.traceback else [line for line in _others(part, sent) if _QUOTED.search(line)]
    claims = [line for line, frame, content in _in_frames(part, sent, found) if frame.is_claim(content)]
    return [*claims, *_guessed(part, sent)]


def _guessed(part: Part, sent: Sequence[str]) -> Iterator[str]:
    """The lines with a text of the judge's kind and words that it has not sent, as of who says whatever might come."""
    known = {found[0] for text in sent for found in _TWO_WORDS.finditer(text)}
    words = {word for text in known for word in text.split()}
    for line in part.said():
        if any(f[0] not in known and {f[1], f[2]} <= words for f in _TWO_WORDS.finditer(line)):
            yield line


def changed(part: Part, sent: Sequence[str], text: str) -> list[str]:
    """The lines in which it said something else in the place of a text that was sent."""
    found = _frames(part, sent)
    if not found:
        # Which texts a change touches depends on the texts: with the first one changed, none is said.
        return [line for line in _others(part, sent) if has_much_of(line, text)]
    return [
        line
        for line, frame, content in _in_frames(part, sent, found)
        if frame.quotes or (content and (content in text or has_much_of(content, text)))
    ]


def _frames(part: Part, sent: Sequence[str]) -> set[Frame]:
    spoken = part.said()
    found = (_frame(line, text) for text in sent if (line := _claim(spoken, text)) is not None)
    return {frame for frame in found if frame is not None}


def _others(part: Part, sent: Sequence[str]) -> list[str]:
    """The lines in which no text is."""
    return [line for line in part.said() if not any(_frame(line, text) for text in sent)]


def _in_frames(part: Part, sent: Sequence[str], frames: set[Frame]) -> Iterator[tuple[str, Frame, str]]:
    for line in _others(part, sent):
        for frame in frames:
            content = frame.content(line)
            if content is not None and frame.is_telling:
                yield line, frame, content


def repeated(part: Part, sent: Sequence[str]) -> dict[str, int]:
    """Texts that were said more often than they were sent, in the same words and in the same way: how often for each.

    A log line and a printed one are two ways, and so are two loggers. Only the words count in which a text is said
    first: a line of another kind may name it again. The number of a line and its time make it no other kind.
    """
    channels: dict[tuple[str, ...], list[str]] = {}
    for channel, line in _by_channel(part):
        channels.setdefault(channel, []).append(line)
    spoken = part.said()
    claims = {text: _kind(claim, text) for text in sent if (claim := _claim(spoken, text)) is not None}
    often = {
        text: max(sum(_kind(line, text) == claim for line in lines) for lines in channels.values())
        for text, claim in claims.items()
    }
    each = {text: math.ceil(times / sent.count(text)) for text, times in often.items()}
    many = {text: times for text, times in each.items() if times > 1}
    # A program may say at its end once more what it said last.
    only_the_last = many.keys() == {next(reversed(claims), None)}
    return {} if only_the_last and max(many.values()) < OFTEN else many


def retold(part: Part, sent: Sequence[str]) -> str:
    """The third of the lines that say, with each new text, all texts before it once more; empty where there are none.

    Of each text, the line with the fewest texts counts: who says each in a line of its own may show all of them beside
    it. Some texts in one line, such as the last two, a batch, or a summary, are no such repetition.
    """
    lines = [(line, {text for text in sent if tells(line, text)}) for line in part.said()]
    holding = [[one for one in lines if text in one[1]] for text in dict.fromkeys(sent)]
    # Two texts may have one line.
    shortest = dict(min(those, key=lambda one: len(one[1])) for those in holding if those)
    grows = all(earlier < later for earlier, later in pairwise(shortest.values()))
    return list(shortest)[2] if grows and len(shortest) >= GROWING else ""


def _claim(lines: Sequence[str], text: str) -> str | None:
    """The line in which a text is said first."""
    return next((line for line in lines if tells(line, text)), None)


def _kind(line: str, text: str) -> tuple[str, ...] | None:
    """The words around a text, with every number in them the same; None where the text is not there."""
    frame = _frame(line, text)
    return tuple(re2.sub(r"[0-9]+", "0", words) for words in (frame.before, frame.after)) if frame else None


def _by_channel(part: Part) -> Iterator[tuple[tuple[str, ...], str]]:
    for event in part.events:
        line = spoken_by(event)
        if line is not None:
            logged = str(event.data.get("text", "")) != line
            yield (event.kind, event.name, str(event.data.get("level", "")), str(logged)), line


def _frame(line: str, text: str) -> Frame | None:
    for form in _forms(text):
        before, found, after = line.partition(form)
        if found:
            return Frame(before, after)
    return None


@functools.lru_cache(maxsize=256)
def _forms(text: str) -> tuple[str, ...]:
    """A text as it is, with its letters escaped as JSON and YAML may do it, and as its bytes are shown."""
    return (text,) if text.isascii() else (text, ascii(text)[1:-1], repr(text.encode())[2:-1])


_DASH = r"[\d\-−][\-−]"
"""A dash that is no sign: behind a digit, or one of a row of dashes."""
_UNSIGNED = rf"(?:^|[^\d\-−]|{_DASH})"
"""The characters before a number without a sign."""
_UNSIGNED_ZERO = rf"(?:^|[^\d.\-−]|{_DASH}|(?:^|\D)\.)"
"""The same before a 0: that of 0.5 and of 1.0 is none, one at the end of a row of dots is."""


def mentions(lines: Sequence[str], number: int) -> bool:
    """True if the number is in one of the lines, with or without separators between its digits."""
    digits = r"[,_' .]?".join(str(abs(number)))
    before, after = _UNSIGNED, r"(?:\D|$)"
    if number < 0:
        before = r"(?:^|\D)[-−]\s?"
    elif number == 0:
        before, after = _UNSIGNED_ZERO, r"(?:[^\d.,]|[.,]\D|[.,]?$)"
    return any(re2.search(f"{before}{digits}{after}", line) for line in lines)
