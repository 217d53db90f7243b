"""Lab 1.2, the talker: a counted greeting on a topic, at a steady rate."""

from __future__ import annotations

from itertools import pairwise

import re2

from autograder.kit.draft import Draft
from autograder.kit.in_words import counted, first_difference
from autograder.kit.model import Advice, Finding
from autograder.kit.published_texts import Publisher, template
from autograder.kit.recipes.publisher import Hears

heard = Hears(messages=8, long_run=20)
MANY = 3
"""Publishers in a row that are too many to be two nodes or two timers."""
TYPE = "std_msgs/msg/String"
talker = Draft(
    "lab_1_2.talker",
    "Lab 1.2 · The talker",
    "Publish a counted greeting on the topic every half second.",
    heard,
)

talker.asks("topic", 2, "Publishes on the right topic", heard.on_topic)
talker.asks("type", 1, "Publishes the right message type", heard.has_type)


@heard.each_text
@talker.criterion("text", 2, "Says the right string")
def text(seen: Publisher, expected: Publisher) -> Finding:
    """Every text is the reference's, the number aside."""
    odd = [
        text for text, form in zip(seen.texts, seen.templates, strict=True) if form not in expected.templates
    ]
    found = f"“{(odd or seen.texts)[0]}”" if seen.texts else "no message arrived"
    if seen.texts and not odd and not seen.went_on:
        found += ", and no more"
    passed = seen.went_on and not odd
    return Finding(passed, f"“{expected.texts[0]}”, “{expected.texts[1]}”, …", found)


@heard.whole_course
@talker.criterion("counter", 2, "Counts up from the start")
def counter(seen: Publisher, expected: Publisher) -> Finding:
    """The numbers are the reference's, from the first message on."""
    numbers = seen.counters
    # Who publishes too slowly, which is another criterion's matter, has not come so far.
    enough = seen.enough - seen.greetings
    all_of_them = len(numbers) >= enough or (bool(numbers) and seen.goes_on_slowly(expected))
    steady = all_of_them and numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    found = ", ".join(map(str, numbers)) if len(numbers) < enough else around(numbers, slip(numbers))
    if steady and (more := uncounted(seen, expected)):
        found = f"{counted(more, 'message')} more before {found}"
    passed = steady and seen.went_on and starts_right(seen, expected)
    if passed and (lost := seen.number_of_first - 1):
        found += f" after {counted(lost, 'message')} before anybody could hear"
    return Finding(passed, row(expected.counters[:5]), found or "no whole number arrived")


talker.asks("rate", 3, "Keeps the rate", heard.keeps_rate)


def starts_right(seen: Publisher, expected: Publisher) -> bool:
    """True if it counted from the reference's first number."""
    return seen.first_number == expected.counters[0]


def uncounted(seen: Publisher, expected: Publisher) -> int:
    """The messages too many, of those before anybody could hear them, for a counter that begins at the start."""
    first, begins = seen.first_number, expected.counters[0]
    return begins - first if first is not None and seen.counters[0] >= begins > first else 0


def slip(numbers: list[int]) -> int:
    """The place of the first number that is not one more than the one before; 0 where all are."""
    return next((place for place, (a, b) in enumerate(pairwise(numbers), 1) if b - a != 1), 0)


def row(numbers: list[int]) -> str:
    """Numbers that go on."""
    return ", ".join(map(str, numbers)) + ", …"


def around(numbers: list[int], place: int) -> str:
    """The numbers on both sides of a place; the first ones where it is near the beginning."""
    first = max(0, place - 3)
    return "…, " * bool(first) + row(numbers[first : first + 6])


talker.knows(
    "field_typo",
    lambda seen, _: bool(seen.texts) and not any(seen.texts),
    "Your messages arrive, but their string is empty: the field was never set.",
    "A String has one field, data. Set it, as in message.data = ...; String(...) ignores a misspelt keyword silently.",
    certain=True,
)
talker.knows(
    "counter_stuck",
    lambda seen, _: len(seen.counters) >= 3 and len(set(seen.counters)) == 1,
    "Every message carries the number {seen.counters[0]}.",
    "In the method that the timer calls, make the string anew, with the counter in an f-string, and add 1 to the "
    "counter below that, as in self.count += 1, with no return above it. Set it to 0 in __init__ only. Without self. "
    "in front, another variable is changed, not the node's.",
    certain=True,
)


@talker.mistake("wrong_text", certain=True)
def wrong_text(seen: Publisher, expected: Publisher) -> Advice | None:
    """Messages arrive, but with another text."""
    odd = next(
        (said for said in seen.texts[seen.greetings :] if template(said) not in expected.templates), None
    )
    if odd is None:
        return None
    asked = text(seen, expected).expected
    if blank := re2.search(r"\{[^{}]*\}|%[ds]|\(?\bself\.\w+\)?", odd):
        return Advice(
            f"Your talker says “{odd}”: {blank[0]} is sent as it is, Python put no number in its place.",
            "Put an f in front of the opening quotation mark, and braces around what Python is to fill in, as in "
            "f'Hello, world! {self.count}'.",
        )
    if re2.search(r"\d[.,]\d", odd):
        return Advice(
            f"Your talker says “{odd}”: its number is not a whole number; the task asks for {asked}",
            "Begin with a whole number, as in self.count = 0 (not 0.0), and add 1; or write int(...) around it.",
        )
    return Advice(
        f"Your talker says “{odd}”; the task asks for {asked}",
        f"{first_difference(template(odd), expected.templates[0])} (N is the number.) Every letter counts, because "
        "other nodes read this string.".replace("#", "N"),
    )


@talker.mistake("counter_start", late=True)
def counter_start(seen: Publisher, expected: Publisher) -> Advice | None:
    """It counts by one, but from another number, or not from its first message on."""
    steady = len(seen.counters) > 1 and all(b - a == 1 for a, b in pairwise(seen.counters))
    unheard, right = uncounted(seen, expected), starts_right(seen, expected)
    if not steady or (right and not seen.greetings):
        return None
    if unheard or right:
        what = f": “{seen.texts[0]}”" if seen.greetings else ", too early for anybody to hear"
        return Advice(
            f"“{seen.texts[seen.greetings]}” was message {seen.greetings + seen.number_of_first} of your node: it "
            f"published {counted(seen.greetings + unheard, 'message')} more before it than it counted{what}.",
            "Fill each message before you publish it, and publish nothing before the first of these: a line such as "
            "“Talker started” goes into the log.",
        )
    first = seen.counters[0] if seen.first_number is None else seen.first_number
    return Advice(
        f"The first message carries the number {first}; the counter must begin at {expected.counters[0]}.",
        f"Set your counter in __init__, as in self.count = {expected.counters[0]}, and add 1 only after the message "
        "was published.",
    )


@talker.mistake("counter_step", late=True)
def counter_step(seen: Publisher, _: Publisher) -> Advice | None:
    """The numbers do not go up by one."""
    numbers = seen.counters
    place = slip(numbers)
    if len(numbers) < 3 or not place:
        return None
    came = f"After {numbers[place - 1]} comes {numbers[place]} ({around(numbers, place)})."
    if seen.begun >= MANY:
        return Advice(
            f"{came} Your node makes a new publisher again and again, and a new one has no subscriber yet.",
            "Call create_publisher once, in __init__, keep what it returns (self.publisher = …) and publish with that.",
        )
    others = sorted(name for name, kind in seen.endpoints.items() if kind == TYPE)
    if len(others) > 1:
        return Advice(
            f"{came} Your node publishes strings on {' and '.join(others)}. What goes elsewhere is missing here.",
            "One publisher is enough: let it publish every message.",
        )
    return Advice(
        f"{came} The numbers must go up by one with each message.",
        "Count once for each published message: one line as self.count += 1 at the end of the method, no loop, and one "
        "timer.",
    )


EXERCISE = talker.exercise(
    text={
        "The topic of this lab is `chatter`, and its type is `std_msgs/msg/String`.": "topic type",
        "The talker has to publish every half second, from the first message on.": "rate",
        "The method does three things: it makes a message, publishes it, and adds one to the count.": "text counter",
        'Says "Hello, world! N" on the topic chatter every 0.5 s; N counts up from 0.': "topic text rate counter",
    },
)
