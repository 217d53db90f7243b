"""Reads times as systems, spreadsheets and people write them."""

from __future__ import annotations

import functools
import itertools
from collections import defaultdict
from datetime import datetime
from typing import TYPE_CHECKING

from babel.core import Locale

if TYPE_CHECKING:
    from collections.abc import Callable

_LANGUAGES = ("en", "de", "fr", "es", "it", "nl", "pt", "sv", "da", "nb", "fi", "pl", "cs", "tr")
_NO_MARKS = str.maketrans(dict.fromkeys(",.:"))
_IN_NUMBERS = ("%Y-%m-%d-%H-%M-%S", "%Y-%m-%d %H:%M:%S %z")


def read_time(text: str) -> datetime | None:
    """Return a time from a name or a list, without regard to its time zone; None if it cannot be read.

    Besides ISO 8601, it reads Blackboard's form (``2025-10-03-14-05-06``), and dates in words as Moodle (``Friday, 3
    October 2025, 2:05 PM``) and Brightspace (``Oct 3, 2025 205 PM``, because the name of a folder cannot contain a
    colon) write them.
    """
    text = text.strip().removesuffix(" UTC") + (" +0000" if text.strip().endswith(" UTC") else "")
    text = text.replace(" Z", "Z")  # YAML writes a space before the Z
    readers: list[Callable[[], datetime]] = [lambda: datetime.fromisoformat(text)]
    readers += [functools.partial(datetime.strptime, text, form) for form in _IN_NUMBERS]
    readers.append(lambda: _in_words(text.translate(_NO_MARKS).casefold()))
    for read in readers:
        try:
            return read()
        except ValueError:
            continue
    return None


def _in_words(text: str) -> datetime:
    """Parse a date with the month as a word before or after the day, then the year and the time of day.

    Raises:
        ValueError: The text is not such a date.
    """
    words = text.split()
    (month,) = (_months()[word] for word in words if word in _months())
    day, year, clock = ("".join(filter(str.isdecimal, word)) for word in words if word[0].isdecimal())
    hour, minute = int(clock[:-2]), int(clock[-2:])
    half = next((half for half in ("am", "pm") if text.endswith(half)), "")
    hour = hour % 12 + 12 * (half == "pm") if half and 0 < hour <= 12 else hour
    return datetime(int(year) if len(year) == 4 else 0, month, int(day), hour, minute)


@functools.cache
def _months() -> dict[str, int]:
    """Return the numbers of the months by name and short form, in several languages. Ambiguous words are left out."""
    meant: dict[str, set[int]] = defaultdict(set)
    for language in _LANGUAGES:
        months = Locale.parse(language).months
        for form, width in itertools.product(("format", "stand-alone"), ("wide", "abbreviated")):
            for number, name in months[form][width].items():
                meant[name.replace(".", "").casefold()].add(number)
    meant["sept"].add(9)
    return {name: numbers.pop() for name, numbers in meant.items() if len(numbers) == 1}
