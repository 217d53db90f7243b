"""A publisher as it was heard, and the questions about its texts."""

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
"""Messages that a publisher has sent that surely was there: a single one may come before anybody can hear it."""
SLOWLY = 1.5
"""Intervals of the reference in one of a slow publisher; and of that, how long it may be silent at the end."""
BURST = 0.3
"""Seconds within which a program that has ended may have published all at once, on a busy machine."""
_NUMBER, _WHOLE = re2.compile(r"-?\d+(?:[.,]\d+|e[+-]?\d+)*"), re2.compile(r"0|-?[1-9]\d{0,17}")
_DIGITS = re2.compile(r"\d{1,18}")


@dataclass(frozen=True)
class Publisher:
    """A publisher, as it was heard.

    Attributes:
        topic: That it is to publish on.
        part: The run in which it was listened to.
        enough: Messages that were listened to; 0 for the reference.
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
        """The texts in their field ``data``."""
        return [str(event.data["fields"].get("data")) for event in self.messages]

    @cached_property
    def counters(self) -> list[int]:
        """The last number of each text, where that is a whole one; without those of greetings."""
        return counters(self.texts[self.greetings :])

    @cached_property
    def templates(self) -> list[str]:
        """The texts with a ``#`` for each whole number."""
        return [template(text) for text in self.texts]

    @cached_property
    def greetings(self) -> int:
        """The number of messages before it begins to count: they have another text, and no number that leads on.

        Who publishes one while it makes its publisher is heard or not, by chance, and counts the same in both cases.
        """
        begins = self.templates.index(Counter(self.templates).most_common(1)[0][0]) if self.texts else 0
        around = last_numbers(self.texts[begins - 1 : begins + 1]) if begins else []
        # Also of a number in another form: 10 goes on from 09.
        leads_on = (
            len(around) > 1 and all(map(_DIGITS.fullmatch, around)) and int(around[1]) == int(around[0]) + 1
        )
        return 0 if leads_on else begins

    @property
    def number_of_first(self) -> int:
        """The number that the first counting message has by DDS, which numbers each publisher's messages from 1.

        Greetings that were heard are left out, so that it tells how many came before it and were not heard.
        """
        counting = self.messages[self.greetings :]
        return max(1, int(counting[0].data.get("number", 1)) - self.greetings) if counting else 1

    @property
    def step(self) -> int:
        """The difference between its first two numbers; 0 if it does not count. Asked of the reference."""
        first = self.counters[:2]
        return first[-1] - first[0] if first else 0

    def place(self, number: int) -> int:
        """Return the place that a number has among its numbers, from 0, below zero if it comes before the first."""
        return (number - self.counters[0]) // self.step if self.step else 0

    @property
    def has_numbers_alone(self) -> bool:
        """True if its messages are whole numbers without a text."""
        return self.templates[:1] == ["#"]

    @property
    def begun(self) -> int:
        """The number of publishers heard from their first message on: DDS numbers each one's messages from 1."""
        return sum(message.data.get("number") == 1 for message in self.messages)

    @property
    def went_on(self) -> bool:
        """True if it published for more than a moment, so that no chance decides whether anything of it is heard."""
        if not self.messages:
            return False
        first, last = self.messages[0], self.messages[-1]
        # By the publisher's clock: what was sent at once may arrive one after the other.
        seconds = float(last.data.get("sent", last.t)) - float(first.data.get("sent", first.t))
        if self.part.ending is not None and last.sim is None and seconds < BURST:
            return False
        return max(len(self.messages), int(last.data.get("number", 1))) >= SURE

    @property
    def pauses(self) -> list[float]:
        """Seconds of its time between one message and the next."""
        times = simulated(self.messages) or sent_times(self.messages)
        return [after - before for before, after in pairwise(times)]

    def goes_on_slowly(self, expected: Publisher) -> bool:
        """True if it publishes at longer intervals than the reference, and did so to the end of the run."""
        if self.part.ending is not None or len(self.pauses) < SURE:
            return False
        silent = self.part.events[-1].moment - self.messages[-1].moment
        return min(self.pauses) >= SLOWLY * max(expected.pauses) and silent <= SLOWLY * max(self.pauses)

    @property
    def endpoints(self) -> dict[str, str]:
        """Its publishers, topic -> type; none of a program that has ended at once.

        Whether the graph showed those before they were gone is a matter of chance. A notebook's class is held until
        they are known, and one whose QoS does not fit was there when that was noticed.
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
        """True if all that it published and said to have published is of one moment, or came at four times the pace.

        A crowded machine may keep it from going on for longer than a moment. The first messages may come before anybody
        can hear them, and the last ones go under with the program: what it said, and the moment in which it was met,
        tell of those.
        """
        said = [e.t for e in self.part.of("output") if expected.templates[0] in template(str(e.data["text"]))]
        met = [event.t for event in self.part.of("matched", self.topic)[:1]]
        for times in (said, [*met, *(event.t for event in self.messages)] if self.messages else []):
            if times and max(times) - min(times) >= max(BURST, (len(times) - 1) * min(expected.pauses) / 4):
                return False
        return True

    def claims(self, expected: Publisher) -> list[str]:
        """The lines in which it says that it published the first of the texts that are expected."""
        return [line for line in self.part.said() if expected.templates[0] in template(line)]


def template(text: str) -> str:
    """A text with a ``#`` for each whole number."""
    return str(_NUMBER.sub(lambda number: "#" if _WHOLE.fullmatch(number[0]) else number[0], text))


def counters(texts: Sequence[str]) -> list[int]:
    """The last number of each text, where that is a whole one."""
    return [int(number) for number in last_numbers(texts) if _WHOLE.fullmatch(number)]


def last_numbers(texts: Sequence[str]) -> list[str]:
    """The last number of each text that has one, in whatever form."""
    return [numbers[-1] for text in texts if (numbers := _NUMBER.findall(text))]
