"""Reads which texts a publisher published and how it counted in them, with the criteria and mistakes about both.

The messages of the reference solution define the right text around the number, the right first number, and the right
step from one number to the next.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import re2

from autograder.kit.in_words import counted, first_difference
from autograder.kit.model import Advice, Finding, card_words, filled_in
from autograder.kit.rules import sent_times, simulated_times, successive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Part

_WORDS = card_words(__file__)


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
class PublisherSeen:
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
    def replaced(self) -> str:
        """In words, how many publishers the program made one after another; empty if its publisher lasts."""
        many = successive(self.part, self.topic)
        return f"{many} publishers, one after another" if many else ""

    @cached_property
    def texts(self) -> list[str]:
        """The ``data`` field of each message."""
        return [str(event.data["fields"].get("data")) for event in self.messages]

    @cached_property
    def counters(self) -> list[int]:
        """The last number of each text, if it is a whole number; texts before the count began are left out."""
        return _counters(self.texts[self.greetings :])

    @cached_property
    def templates(self) -> list[str]:
        """The texts with each whole number replaced by ``#``."""
        return [template(text) for text in self.texts]

    @cached_property
    def greetings(self) -> int:
        """The number of messages before the publisher began to count. Their words differ from those of later messages.

        Early messages must not change the verdict: if they are published as soon as the publisher exists, the judge
        receives them only by chance.
        """
        begins = self.templates.index(Counter(self.templates).most_common(1)[0][0]) if self.texts else 0
        around = _last_numbers(self.texts[begins - 1 : begins + 1]) if begins else []
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
        times = simulated_times(self.messages) or sent_times(self.messages)
        return [after - before for before, after in pairwise(times)]

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

    def at_once(self, expected: PublisherSeen) -> bool:
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

    def claims(self, expected: PublisherSeen) -> list[str]:
        """Return the lines in which the program says that it published the first of the expected texts."""
        return [line for line in self.part.said() if expected.templates[0] in template(line)]


def template(text: str) -> str:
    """Return a text with each whole number replaced by ``#``."""
    return str(_NUMBER.sub(lambda number: "#" if _WHOLE.fullmatch(number[0]) else number[0], text))


def _counters(texts: Sequence[str]) -> list[int]:
    """Return the last number of each text, if it is a whole number."""
    return [int(number) for number in _last_numbers(texts) if _WHOLE.fullmatch(number)]


def _last_numbers(texts: Sequence[str]) -> list[str]:
    """Return the last number of each text, as it is written; texts without a number are left out."""
    return [numbers[-1] for text in texts if (numbers := _NUMBER.findall(text))]


def says_text(seen: PublisherSeen, expected: PublisherSeen) -> Finding:
    """Decide whether every text equals the reference's, apart from the number."""
    odd = [
        text for text, form in zip(seen.texts, seen.templates, strict=True) if form not in expected.templates
    ]
    found = f"“{(odd or seen.texts)[0]}”" if seen.texts else "no message arrived"
    if seen.texts and not odd and not seen.went_on:
        found += ", and no more"
    passed = seen.went_on and not odd
    return Finding(passed, f"“{expected.texts[0]}”, “{expected.texts[1]}”, …", found)


def counts(seen: PublisherSeen, expected: PublisherSeen) -> Finding:
    """Decide whether the numbers in the messages are those of the reference, from the first message on.

    Raises:
        ValueError: The reference solution does not count.
    """
    numbers, step = seen.counters, expected.step
    if not step:
        raise ValueError("the reference solution does not count, so leave out heard.counts(...)")
    # A slow publisher sent fewer numbers; the rate criterion judges that.
    enough = seen.enough - seen.greetings
    all_of_them = len(numbers) >= enough or (bool(numbers) and _goes_on_slowly(seen, expected))
    steady = all_of_them and not _slip(numbers, step)
    found = ", ".join(map(str, numbers)) if len(numbers) < enough else _around(numbers, _slip(numbers, step))
    if steady and (more := _uncounted(seen, expected)):
        found = f"{counted(more, 'message')} more before {found}"
    passed = steady and seen.went_on and _starts_right(seen, expected) and not seen.replaced
    if passed and (lost := seen.number_of_first - 1):
        found += f" after {counted(lost, 'message')} before the judge could receive one"
    found = seen.replaced or found or "no whole number arrived"
    return Finding(passed, _row(expected.counters[:5]), found)


def _goes_on_slowly(seen: PublisherSeen, expected: PublisherSeen) -> bool:
    """Return True if the publisher is slower than the reference solution and published until the run's end."""
    if seen.part.ending is not None or len(seen.pauses) < SURE:
        return False
    silent = seen.part.events[-1].moment - seen.messages[-1].moment
    return min(seen.pauses) >= SLOWLY * max(expected.pauses) and silent <= SLOWLY * max(seen.pauses)


def field_typo(seen: PublisherSeen, _: PublisherSeen) -> Advice | None:
    """Return advice if all texts are empty."""
    if not seen.texts or any(seen.texts):
        return None
    return filled_in(_WORDS["field_typo"])


_UNFILLED = re2.compile(r"\{[^{}]*\}|%[ds]|\(?\bself\.\w+\)?")
"""Matches a variable of the program that Python did not replace by its value."""


@dataclass(frozen=True)
class Counting:
    """The known mistakes of a publisher that counts.

    Attributes:
        variable: The name that the advice uses for the counter, such as ``"self.count"``.
    """

    variable: str

    def wrong_text(self, seen: PublisherSeen, expected: PublisherSeen) -> Advice | None:
        """Return advice if the text of a message differs from the reference's."""
        texts = seen.texts[seen.greetings :]
        odd = next((said for said in texts if template(said) not in expected.templates), None)
        if odd is None:
            return None
        asked, form = says_text(seen, expected).expected, expected.templates[0]
        if blank := _UNFILLED.search(odd):
            return filled_in(
                _WORDS["not_filled_in"], odd=odd, blank=blank, form=form.replace("#", f"{{{self.variable}}}")
            )
        return Advice(
            f"Your talker says “{odd}”; the task asks for {asked}",
            f"{first_difference(template(odd), form)} (N stands for the number.) Every letter counts, because other "
            "nodes read this string.".replace("#", "N"),
        )

    def stuck(self, seen: PublisherSeen, expected: PublisherSeen) -> Advice | None:
        """Return advice if every message has the same number."""
        if len(seen.counters) < 3 or len(set(seen.counters)) > 1:
            return None
        made = (
            "make a new message with the counter"
            if expected.templates[:1] == ["#"]  # The texts are numbers and nothing else.
            else "make a new string from the counter, with an f-string"
        )
        return filled_in(
            _WORDS["counter_stuck"],
            seen=seen,
            made=made,
            changes=self._changes(expected, "the counter"),
            statement=self._statement(expected),
            expected=expected,
        )

    def start(self, seen: PublisherSeen, expected: PublisherSeen) -> Advice | None:
        """Return advice if the step is right, but the first number is wrong, or other messages come before it."""
        steady = len(seen.counters) > 1 and not _slip(seen.counters, expected.step)
        unheard, right = _uncounted(seen, expected), _starts_right(seen, expected)
        if not steady or (right and not seen.greetings):
            return None
        if unheard or right:
            what = f": “{seen.texts[0]}”" if seen.greetings else ", before any subscriber was connected"
            return filled_in(
                _WORDS["counter_start_late"],
                said=seen.texts[seen.greetings],
                number=seen.greetings + seen.number_of_first,
                before=counted(seen.greetings + unheard, "message"),
                what=what,
            )
        first, begins = _first_number(seen, expected), expected.counters[0]
        return filled_in(
            _WORDS["counter_start"],
            first=seen.counters[0] if first is None else first,
            begins=begins,
            variable=self.variable,
            changes=self._changes(expected),
        )

    def step(self, seen: PublisherSeen, expected: PublisherSeen) -> Advice | None:
        """Return advice if the numbers do not change by the right step."""
        numbers = seen.counters
        place = _slip(numbers, expected.step)
        if len(numbers) < 3 or not place:
            return None
        came = f"After {numbers[place - 1]} comes {numbers[place]} ({_around(numbers, place)})."
        way, by = ("up", expected.step) if expected.step > 0 else ("down", -expected.step)
        return filled_in(
            _WORDS["counter_step"],
            came=came,
            way=way,
            by="one" if by == 1 else by,
            statement=self._statement(expected),
        )

    def _statement(self, expected: PublisherSeen) -> str:
        return f"{self.variable} {'+' if expected.step > 0 else '-'}= {abs(expected.step)}"

    @staticmethod
    def _changes(expected: PublisherSeen, counter: str = "") -> str:
        by = abs(expected.step)
        if expected.step > 0:
            return f"add {by} to {counter}" if counter else f"add {by}"
        return f"take {by} from {counter}" if counter else f"take {by} away"


def _first_number(seen: PublisherSeen, expected: PublisherSeen) -> int | None:
    """Return the number in the publisher's first message, even if the judge could not receive it; None if unknown.

    A loop may publish before any subscriber can receive the message, so the first received number may be a later one.
    The judge knows how many messages it missed, because DDS numbers them, and counts back from the received number. The
    result may lie before the reference's first number, if some of the missed messages contained no number.
    """
    first = _counters(seen.texts[seen.greetings :][:1])
    return first[0] - expected.step * (seen.number_of_first - 1) if first else None


def _starts_right(seen: PublisherSeen, expected: PublisherSeen) -> bool:
    return _first_number(seen, expected) == expected.counters[0]


def _uncounted(seen: PublisherSeen, expected: PublisherSeen) -> int:
    """Return how many of the messages that the judge missed at the start cannot have been part of the count."""
    if _first_number(seen, expected) is None or (place := expected.place(seen.counters[0])) < 0:
        return 0
    return max(0, seen.number_of_first - 1 - place)


def _slip(numbers: list[int], step: int) -> int:
    """Return the index of the first number that does not follow from the one before; 0 if all numbers do."""
    return next((place for place, (a, b) in enumerate(pairwise(numbers), 1) if b - a != step), 0)


def _row(numbers: list[int]) -> str:
    return ", ".join(map(str, numbers)) + ", …"


def _around(numbers: list[int], place: int) -> str:
    """Return the numbers around an index as text; the first numbers if the index is near the beginning."""
    first = max(0, place - 3)
    return "…, " * bool(first) + _row(numbers[first : first + 6])
