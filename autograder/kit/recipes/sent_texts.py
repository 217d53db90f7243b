"""Draws the texts that the judge sends to a listener: no program can guess them, and careless programs change some."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from random import Random

SINGLY = 12
"""The number of texts that are sent one by one, each after the subject has reported the text before."""
AT_PACE = 8
"""The number of texts in a series that is sent in real time at the given pace, without waiting for the subject."""
TRIES = 3
"""The maximum number of series at the given pace. Several are needed, because a busy machine may be too slow for a
moment.
"""
GREETING = "Hello, world!"
"""The text with which many talkers begin their messages, and which some of the judge's texts contain."""
KINDS = 6
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
        twice = random.choice(row[:-1])
        rest = [place for place in row if place not in (twice, twice + 1)]
        greets, greeted, long, marks, far, single = random.sample(rest, KINDS)
        texts[twice + 1] = texts[twice]
        texts[greets] = f"{GREETING} {texts[greets].rpartition(' ')[2]}"
        texts[greeted] = f"{texts[greeted]} {GREETING}"
        texts[long] = f"{random.choice(_WORDS).upper()} {' '.join(random.sample(_WORDS, 4))} {texts[long]}"
        texts[marks] = f"{{{random.choice(_WORDS)}}} {random.randrange(10, 100)}% {texts[marks]}"
        texts[far] = f"{random.choice(_ELSEWHERE)}  {texts[far]}"
        texts[single] = texts[single].replace(" ", "_")
    return texts
