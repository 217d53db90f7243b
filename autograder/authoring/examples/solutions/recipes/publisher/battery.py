"""A publisher: the battery tells its charge, a number on a topic, at a steady rate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.model import Finding
from autograder.kit.recipes.publisher import Hears

if TYPE_CHECKING:
    from autograder.kit.published_texts import Publisher

heard = Hears(messages=8, long_run=20)
battery = Draft(
    "publisher.battery",
    "A publisher · The battery",
    "Publish the charge, 100 percent and one less each time, every 0.5 s.",
    heard,
)

battery.asks("topic", 2, "Publishes on the right topic", heard.on_topic)
battery.asks("type", 1, "Publishes the right message type", heard.has_type)


@heard.whole_course
@battery.criterion("charge", 4, "Counts down from 100")
def charge(seen: Publisher, expected: Publisher) -> Finding:
    """The charges are the reference's, also where the first ones left before anybody could hear them.

    DDS numbers each publisher's messages from 1, so it is known how many those were.
    """
    start, second = expected.counters[:2]
    numbers = [int(message.data["number"]) for message in seen.messages]
    due = [start + (second - start) * (number - 1) for number in numbers]
    passed = len(seen.counters) >= seen.enough and seen.counters == due
    return Finding(
        passed, row(expected.counters), row(seen.counters) if seen.counters else "no number arrived"
    )


battery.asks("rate", 3, "Keeps the rate", heard.keeps_rate)


def row(numbers: list[int]) -> str:
    """The first numbers of many."""
    return ", ".join(map(str, numbers[:5])) + ", …"


battery.knows(
    "counter_stuck",
    lambda seen, _: len(seen.counters) > 2 and len(set(seen.counters)) == 1,
    "Every message says {seen.counters[0]} percent: the charge never changes.",
    "Take 1 away at the end of the method that the timer calls: self.charge -= 1.",
    certain=True,
)
battery.knows(
    "counter_step",
    lambda seen, _: len(seen.counters) > 2 and seen.counters[0] < seen.counters[1] < seen.counters[2],
    "The charge goes up: {seen.counters[0]}, {seen.counters[1]}, …",
    "Take 1 away each time: self.charge -= 1.",
    certain=True,
)


EXERCISE = battery.exercise()
