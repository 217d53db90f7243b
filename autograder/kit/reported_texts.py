"""Draws the texts that the judge sends to a listener, and finds texts and numbers in the lines that a subject reports.

No program can guess the texts, and careless programs change some of them. Each line that a listener printed, logged or
returned is compared with the texts: the line may report a text, change it, repeat it, or invent a text that was never
sent.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import re2

from autograder.kit.model import Advice
from autograder.kit.output.spoken_lines import spoken_by

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from random import Random

    from autograder.kit.evidence import Event, Part


SINGLY = 12
"""The number of texts that are sent one by one, each after the subject has reported the text before."""
AT_PACE = 8
"""The number of texts in a series that is sent in real time at the given pace, without waiting for the subject."""
TRIES = 3
"""The maximum number of series at the given pace. Several are needed, because a busy machine may be too slow for a
moment.
"""
PAIRS = 3
"""The number of texts in the first half of each series after which the next text is sent at once: a listener has to
report both. Between the two, the judge waits until the first one is handled, so a listener that is too slow for the
pace loses texts of the second half, in which the judge waits for none.
"""
GREETING = "Hello, world!"
"""The text with which many talkers begin their messages, and which some of the judge's texts contain."""
_UNUSUAL = 6
"""The number of unusual texts in each series, not counting the text that comes twice."""

_WORDS = (
    "amber", "birch", "cedar", "delta", "ember", "fjord", "grove", "harbour", "islet", "juniper", "kelp", "lagoon",
    "meadow", "north", "orchard", "pebble", "quarry", "river", "summit", "tundra",
)  # fmt: skip
_ELSEWHERE = ("mgła", "łąka", "řeka", "erdő", "tűz")
"""Words of other languages with letters that JSON, YAML and Python all escape in the same way."""


def random_texts(random: Random) -> list[str]:
    """Return random texts, each with two words and a number. No text is contained in another text.

    In each series, one text comes twice in a row. Some texts are unusual: they have the greeting of many talkers before
    or after the words, are long and in capitals, contain braces and a percent sign, contain letters beyond ASCII and
    two spaces, or contain no space.
    """
    count = 1 + TRIES * AT_PACE + SINGLY
    words = [f"{random.choice(_WORDS)} {random.choice(_WORDS)}" for _ in range(count)]
    texts = [
        f"{two} {number}" for two, number in zip(words, random.sample(range(1000, 10000), count), strict=True)
    ]
    at_pace = [range(1 + AT_PACE * i, 1 + AT_PACE * (i + 1)) for i in range(TRIES)]
    for row in (*at_pace, range(count - SINGLY, count)):
        # Of two equal texts, the report of one counts for both, so no text that a slow listener loses is one of them.
        twice = random.choice(row[: AT_PACE // 2])
        # A change to one of the two equal texts would make them differ.
        rest = [place for place in row if place not in (twice, twice + 1)]
        greets, greeted, long, marks, far, single = random.sample(rest, _UNUSUAL)
        texts[twice + 1] = texts[twice]
        texts[greets] = f"{GREETING} {texts[greets].rpartition(' ')[2]}"
        texts[greeted] = f"{texts[greeted]} {GREETING}"
        texts[long] = f"{random.choice(_WORDS).upper()} {' '.join(random.sample(_WORDS, 4))} {texts[long]}"
        texts[marks] = f"{{{random.choice(_WORDS)}}} {random.randrange(10, 100)}% {texts[marks]}"
        texts[far] = f"{random.choice(_ELSEWHERE)}  {texts[far]}"
        texts[single] = texts[single].replace(" ", "_")
    return texts


def drawn_pairs(random: Random, texts: Sequence[str]) -> list[str]:
    """Draw the texts of :func:`random_texts` that the next text of their series follows at once."""
    rows = [texts[1 + AT_PACE * i : 1 + AT_PACE * (i + 1)] for i in range(TRIES)]
    middle = AT_PACE // 2
    firsts = ([text for text in row[:middle] if text not in row[middle:]] for row in rows)
    return [text for first in firsts for text in random.sample(first, PAIRS)]


_QUOTED = re2.compile(r"[\"“«].*[\pL\pN_].*[\"”»]")
_OPENING, _CLOSING = tuple("\"'“‘«`"), tuple("\"'”’»`")
_A_TALKERS = re2.compile(r"\W*[Hh]ello,? [Ww]orld!?\W*\d+\W*")
"""Matches texts of talkers in this course and in the official tutorials."""
_TWO_WORDS = re2.compile(r"\b([a-z]+) ([a-z]+) \d{4}\b")
"""Matches the two random words and the number in a text of :func:`random_texts`."""
_BRACES = re2.compile(r"\{[\pL_][^{}]*\}")
"""Matches a variable's name in braces, which an f-string would have replaced by the value."""
_BYTE = ("\\x00", "\0")
"""A zero byte, as Python's repr shows it and raw. In a printed message that is still serialized, such bytes surround
the text.
"""
MUCH = 5
"""A line with this many successive characters of a text, or more, was made from that text."""
OFTEN = 3
"""The minimum number of reports that count as a repetition if only the last text is repeated."""
GROWING = 6
"""The minimum number of lines, each of which contains all earlier texts, that count as repeating. It is greater than
two or three, because a program may show a few recent texts.
"""


def tells(line: str, text: str) -> bool:
    """Return True if a line contains a text unchanged.

    A text inside the printed bytes of a serialized message does not count, because the program did not decode it.
    """
    found = _frame(line, text)
    return found is not None and not found.before.endswith(_BYTE) and not found.after.startswith(_BYTE)


def is_said(text: str, part: Part, *, after: Event | None = None) -> bool:
    """Return True if the subject printed, logged or returned a text; with ``after``, only after that event."""
    return any(tells(line, text) for line in part.said(after=after))


def said_first_after(event: Event | None, part: Part) -> list[str]:
    """Return the lines that the subject printed, logged or returned for the first time after an event.

    Lines from before the event are left out, because a log line is recorded twice, as output and on /rosout, and the
    second copy may come late. Return no lines if there is no event.
    """
    if event is None:
        return []
    later, everything = part.said(after=event), part.said()
    before = everything[: len(everything) - len(later)]
    return [line for line in later if line not in before]


def not_filled_in(lines: Sequence[str]) -> Advice | None:
    """Return advice if a line contains a variable's name in braces, because the f before its string is missing."""
    line = next((line for line in lines if _BRACES.search(line)), None)
    if line is None:
        return None
    return Advice(
        f"Your program said “{line}”: Python did not replace the braces by a value, because there is no f before the "
        "string.",
        'Write f directly before the quotation mark: f"...". Python then replaces the braces by the value.',
    )


def has_much_of(line: str, text: str) -> bool:
    """Return True if a line contains so many successive characters of a text that they were made from it."""
    if tells(line, text) or any(byte in line for byte in _BYTE):
        return False
    where, what = line.lower(), text.lower()
    return any(what[i : i + MUCH] in where for i in range(len(what) - MUCH + 1))


@dataclass(frozen=True)
class _Frame:
    """The words before and after a received text in a program's lines, such as "I heard: ".

    Attributes:
        before: The words before the text, in the same line.
        after: The words after the text.
    """

    before: str
    after: str

    def content(self, line: str) -> str | None:
        """Return the part of a line between the surrounding words; None if the line has other words."""
        long_enough = len(line) >= len(self.before) + len(self.after)
        if not (long_enough and line.startswith(self.before) and line.endswith(self.after)):
            return None
        return line[len(self.before) : len(line) - len(self.after)]

    @property
    def _has_quotes(self) -> bool:
        """True if the surrounding words put the text in quotation marks."""
        return self.before.endswith(_OPENING) and self.after.startswith(_CLOSING)

    @property
    def quotes(self) -> bool:
        """True if the quotation marks belong to the text, and not to every line, as in JSON or ``msg="…"``."""
        rest = self.before[:-1]
        return self._has_quotes and not rest.endswith("=") and not any(mark in rest for mark in _OPENING)

    def is_claim(self, content: str) -> bool:
        """Return True if a line with the surrounding words and this content claims to report a received text.

        Many programs begin each line with their name, even a line about what they wait for. So a content without
        quotation marks counts only if it looks like a talker's text.
        """
        return self.quotes or (self._has_quotes and not content) or _A_TALKERS.fullmatch(content) is not None


def invented(part: Part, sent: Sequence[str]) -> list[str]:
    """Return the texts that the subject claims to have heard although they were never sent.

    The first line with a sent text shows which words the subject puts around a text. If the subject puts the same words
    around a text that was not sent, this text is invented. If the subject reported none of the sent texts, every quoted
    text counts as invented.
    """
    found = _frames(part, sent)
    if not found:
        return [] if part.traceback else [line for line in _others(part, sent) if _QUOTED.search(line)]
    claims = [line for line, frame, content in _in_frames(part, sent, found) if frame.is_claim(content)]
    return [*claims, *_guessed(part, sent)]


def _guessed(part: Part, sent: Sequence[str]) -> Iterator[str]:
    """Yield the lines with a text that was not sent but looks like the judge's texts, as if it was guessed."""
    known = {found[0] for text in sent for found in _TWO_WORDS.finditer(text)}
    words = {word for text in known for word in text.split()}
    for line in part.said():
        if any(f[0] not in known and {f[1], f[2]} <= words for f in _TWO_WORDS.finditer(line)):
            yield line


def changed(part: Part, sent: Sequence[str], text: str) -> list[str]:
    """Return the lines in which the subject reported a changed form of a sent text."""
    found = _frames(part, sent)
    if not found:
        # No sent text is reported unchanged, so the surrounding words are unknown.
        return [line for line in _others(part, sent) if has_much_of(line, text)]
    return [
        line
        for line, frame, content in _in_frames(part, sent, found)
        if frame.quotes or (content and (content in text or has_much_of(content, text)))
    ]


def _frames(part: Part, sent: Sequence[str]) -> set[_Frame]:
    spoken = part.said()
    found = (_frame(line, text) for text in sent if (line := _claim(spoken, text)) is not None)
    return {frame for frame in found if frame is not None}


def _others(part: Part, sent: Sequence[str]) -> list[str]:
    """Return the lines that contain none of the sent texts."""
    return [line for line in part.said() if not any(_frame(line, text) for text in sent)]


def _in_frames(part: Part, sent: Sequence[str], frames: set[_Frame]) -> Iterator[tuple[str, _Frame, str]]:
    for line in _others(part, sent):
        for frame in frames:
            content = frame.content(line)
            # Fewer than four characters before the text may begin other lines by chance.
            if content is not None and len(frame.before.strip()) > 3:
                yield line, frame, content


def repeated(part: Part, sent: Sequence[str]) -> dict[str, int]:
    """Return the texts that were reported more often than they were sent, each with its count.

    A report is counted only if its other words are those of the text's first report, because a line with other words
    may mention the text again. (Words that differ only in a number, such as a time, count as the same.) A report that
    is both logged and printed, or logged by two loggers, is counted once.
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
    # A program may repeat its last line once when it ends.
    only_the_last = many.keys() == {next(reversed(claims), None)}
    return {} if only_the_last and max(many.values()) < OFTEN else many


def retold(part: Part, sent: Sequence[str]) -> str:
    """Return an example line if the subject repeats all earlier texts with each new text; empty if it does not.

    A program may report each text in a line of its own and also show all texts. So for each text, only the line with
    the fewest texts is examined. A few texts in one line, such as the last two or a summary, are not a repetition.
    """
    lines = [(line, {text for text in sent if tells(line, text)}) for line in part.said()]
    holding = [[one for one in lines if text in one[1]] for text in dict.fromkeys(sent)]
    # Maps each shortest line to its texts. Two texts may have the same shortest line, which counts only once.
    shortest = dict(min(those, key=lambda one: len(one[1])) for those in holding if those)
    grows = all(earlier < later for earlier, later in pairwise(shortest.values()))
    return list(shortest)[2] if grows and len(shortest) >= GROWING else ""


def _claim(lines: Sequence[str], text: str) -> str | None:
    """Return the first line that contains a text; None if there is none."""
    return next((line for line in lines if tells(line, text)), None)


def _kind(line: str, text: str) -> tuple[str, ...] | None:
    """Return the words around a text, with each number replaced by 0; None if the line does not contain the text."""
    frame = _frame(line, text)
    return tuple(re2.sub(r"[0-9]+", "0", words) for words in (frame.before, frame.after)) if frame else None


def _by_channel(part: Part) -> Iterator[tuple[tuple[str, ...], str]]:
    for event in part.events:
        line = spoken_by(event)
        if line is not None:
            logged = str(event.data.get("text", "")) != line
            yield (event.kind, event.name, str(event.data.get("level", "")), str(logged)), line


def _frame(line: str, text: str) -> _Frame | None:
    for form in _forms(text):
        before, found, after = line.partition(form)
        if found:
            return _Frame(before, after)
    return None


@functools.lru_cache(maxsize=256)
def _forms(text: str) -> tuple[str, ...]:
    """Return the forms of a text in output: unchanged, with escaped letters as in JSON, and as printed bytes."""
    return (text,) if text.isascii() else (text, ascii(text)[1:-1], repr(text.encode())[2:-1])


_DASH = r"[\d\-−][\-−]"
"""Matches a dash that is not a minus sign, because it follows a digit or another dash."""
_UNSIGNED = rf"(?:^|[^\d\-−]|{_DASH})"
"""Matches the text before a number that has no sign."""
_UNSIGNED_ZERO = rf"(?:^|[^\d.\-−]|{_DASH}|(?:^|\D)\.)"
"""Matches the text before a 0 that has no sign. A 0 in 0.5 or 1.0 does not count as the number 0, but a 0 after a row
of dots does.
"""


def mentions(lines: Sequence[str], number: int) -> bool:
    """Return True if one of the lines contains the number, with or without separators between its digits."""
    digits = r"[,_' .]?".join(str(abs(number)))
    before, after = _UNSIGNED, r"(?:\D|$)"
    if number < 0:
        before = r"(?:^|\D)[-−]\s?"
    elif number == 0:
        before, after = _UNSIGNED_ZERO, r"(?:[^\d.,]|[.,]\D|[.,]?$)"
    return any(re2.search(f"{before}{digits}{after}", line) for line in lines)
