"""Reads from the evidence which texts a publisher published, and how it counted in them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import re2

from autograder.kit.rate import sent_times, simulated

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Part

SURE = 2
"""The minimum number of messages that the judge surely notices. It is not one, because a single message may come before
the judge can receive it.
"""
SLOWLY = 1.5
"""A publisher is slow if its intervals are at least this many times as long as the reference's. It may also be silent
for this many of its own intervals at the end of the run.
"""
BURST = 0.3
"""A limit in seconds. If a program published for a shorter time and ended, it may have published everything at once,
and a busy machine delayed some messages.
"""
_NUMBER, _WHOLE = re2.compile(r"-?\d+(?:[.,]\d+|e[+-]?\d+)*"), re2.compile(r"0|-?[1-9]\d{0,17}")
_DIGITS = re2.compile(r"\d{1,18}")


@dataclass(frozen=True)
class Publisher:
    """A publisher, as far as the judge received its messages in one run.

    Attributes:
        topic: The topic on which the task says to publish.
        part: The run in which the judge listened.
        enough: The number of messages that the judge waited for; 0 for the reference.
    """

    topic: str
    part: Part
    enough: int = 0

    @cached_property
    def messages(self) -> list[Event]:
        """The messages on the topic, in order."""
        return self.part.of("message", self.topic)

    @cached_property
    def texts(self) -> list[str]:
        """The ``data`` field of each message."""
        return [str(event.data["fields"].get("data")) for event in self.messages]

    @cached_property
    def counters(self) -> list[int]:
        """The last number of each text, if it is a whole number; texts before the count began are left out."""
        return counters(self.texts[self.greetings :])

    @cached_property
    def templates(self) -> list[str]:
        """The texts with each whole number replaced by ``#``."""
        return [template(text) for text in self.texts]

    @cached_property
    def greetings(self) -> int:
        """The number of messages before the publisher began to count. Their words differ from those of later messages.

        These messages must not change the verdict: if they are published as soon as the publisher exists, the judge
        receives them only by chance.
        """
        begins = self.templates.index(Counter(self.templates).most_common(1)[0][0]) if self.texts else 0
        around = last_numbers(self.texts[begins - 1 : begins + 1]) if begins else []
        # From 09 to 10 the template changes, because 09 is not a whole number in its usual form. But the count goes on,
        # so the texts up to 09 are not greetings.
        leads_on = (
            len(around) > 1 and all(map(_DIGITS.fullmatch, around)) and int(around[1]) == int(around[0]) + 1
        )
        return 0 if leads_on else begins

    @property
    def number_of_first(self) -> int:
        """The DDS sequence number of the first message that counts. DDS numbers each publisher's messages from 1.

        The greetings that the judge received are subtracted, so the number tells how many earlier messages were missed.
        """
        counting = self.messages[self.greetings :]
        return max(1, int(counting[0].data.get("number", 1)) - self.greetings) if counting else 1

    @property
    def step(self) -> int:
        """The difference between the reference's first two numbers; 0 if the reference does not count."""
        first = self.counters[:2]
        return first[-1] - first[0] if first else 0

    def place(self, number: int) -> int:
        """Return the position of a number in the publisher's count, from 0; negative if it is before the first."""
        return (number - self.counters[0]) // self.step if self.step else 0

    @property
    def has_numbers_alone(self) -> bool:
        """True if the texts of the messages are whole numbers and nothing else."""
        return self.templates[:1] == ["#"]

    @property
    def went_on(self) -> bool:
        """True if the publisher published for so long that the judge cannot have missed it by chance."""
        if not self.messages:
            return False
        first, last = self.messages[0], self.messages[-1]
        # Messages sent at the same time may arrive one after the other, so the publisher's clock is used.
        seconds = float(last.data.get("sent", last.t)) - float(first.data.get("sent", first.t))
        if self.part.ending is not None and last.sim is None and seconds < BURST:
            return False
        return max(len(self.messages), int(last.data.get("number", 1))) >= SURE

    @property
    def pauses(self) -> list[float]:
        """The times between successive messages, in seconds of the subject's time."""
        times = simulated(self.messages) or sent_times(self.messages)
        return [after - before for before, after in pairwise(times)]

    def goes_on_slowly(self, expected: Publisher) -> bool:
        """Return True if the publisher is slower than the reference solution and published until the run's end."""
        if self.part.ending is not None or len(self.pauses) < SURE:
            return False
        silent = self.part.events[-1].moment - self.messages[-1].moment
        return min(self.pauses) >= SLOWLY * max(expected.pauses) and silent <= SLOWLY * max(self.pauses)

    @property
    def endpoints(self) -> dict[str, str]:
        """The subject's publishers as topic -> type; empty for a program that ended at once.

        The publishers of such a program are left out, because chance decides whether the graph shows them.

        A notebook's class does not end before its publishers are known, so they always count. A publisher with an
        incompatible QoS counts only if the mismatch was recorded well before the end.
        """
        ending, misfit = self.part.ending, self.part.first("mismatch", self.topic)
        met = (
            ending is None
            or self.part.first("subject", "constructed") is not None
            or self.went_on
            or (misfit is not None and ending.t - misfit.t >= BURST)
        )
        return self.part.endpoints("publisher") if met else {}

    def at_once(self, expected: Publisher) -> bool:
        """Return True if the publisher published everything within a moment, or at more than four times the right rate.

        The rate decides if a busy machine makes a burst last longer than a moment. The program's log lines and the time
        at which the judge discovered the publisher count, too, because the first and last messages may have been lost.
        """
        said = [e.t for e in self.part.of("output") if expected.templates[0] in template(str(e.data["text"]))]
        met = [event.t for event in self.part.of("matched", self.topic)[:1]]
        for times in (said, [*met, *(event.t for event in self.messages)] if self.messages else []):
            if times and max(times) - min(times) >= max(BURST, (len(times) - 1) * min(expected.pauses) / 4):
                return False
        return True

    def claims(self, expected: Publisher) -> list[str]:
        """Return the lines in which the program says that it published the first of the expected texts."""
        return [line for line in self.part.said() if expected.templates[0] in template(line)]


def template(text: str) -> str:
    """Return a text with each whole number replaced by ``#``."""
    return str(_NUMBER.sub(lambda number: "#" if _WHOLE.fullmatch(number[0]) else number[0], text))


def counters(texts: Sequence[str]) -> list[int]:
    """Return the last number of each text, if it is a whole number."""
    return [int(number) for number in last_numbers(texts) if _WHOLE.fullmatch(number)]


def last_numbers(texts: Sequence[str]) -> list[str]:
    """Return the last number of each text, as it is written; texts without a number are left out."""
    return [numbers[-1] for text in texts if (numbers := _NUMBER.findall(text))]
