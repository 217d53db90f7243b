"""A publisher that counts in steps of its own, up or down, in texts or in bare numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.draft import Draft
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.recipes.publisher import Publisher

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.model import Exercise

TOPIC, PERIOD = "/charge", 0.5


def heard(contents: Sequence[object], first: int = 1) -> list[Event]:
    """Messages in simulated time, the first being the publisher's ``first``."""
    return [
        Event(
            0.3 + 0.1 * n,
            "message",
            TOPIC,
            {"fields": {"data": content}, "number": first + n},
            100 + PERIOD * n,
        )
        for n, content in enumerate(contents)
    ]


def exercise() -> Exercise:
    """A publisher whose text and numbers are judged."""
    hears = Publisher()
    draft = Draft("lab.it", "", "", hears)
    draft.asks("text", "", hears.says_text(), points=1)
    draft.asks("counts", "", hears.counts("self.charge"), points=1)
    draft.asks("rate", "", hears.keeps_rate, points=1)
    return draft.exercise()


def evidence(due: Sequence[object], seen: list[Event]) -> Evidence:
    """What was heard, beside a reference of that many messages."""
    ends = {"publisher": {TOPIC: "std_msgs/msg/Any"}}
    there = Event(0.2, "interface", "graph", ends)
    reference = Reference("lab.it", ends, [Part("talking", {}, heard(due))])
    return Evidence([Part("talking", {}, [there, *seen])], reference)


def failed(found: Evidence) -> set[str]:
    return {criterion.name for criterion in exercise().criteria if not criterion.judge(found).passed}


def told(found: Evidence) -> tuple[str, str, str]:
    """The key of the first mistake that is recognized, and its advice."""
    ladder = exercise().mistakes
    key, advice = next((one.key, advice) for one in ladder if (advice := one.recognize(found)))
    return key, advice.text, advice.next_step


DOWN, UP = range(100, 80, -1), range(5, 105, 5)


@pytest.mark.parametrize("row", [DOWN, UP, range(0, -20, -1)], ids=["down", "by five", "below zero"])
@pytest.mark.parametrize("of", [int, "charge: {} %".format], ids=["numbers", "texts"])
def test_what_the_reference_counts_is_right_even_if_nobody_heard_its_first_messages(
    row: range, of: Callable[[int], object]
) -> None:
    due = [of(n) for n in row]
    later = [of(row.start + row.step * n) for n in range(2, 22)]
    assert failed(evidence(due, heard(due))) == set()
    late = [Event(e.t + 2.0, e.kind, e.name, e.data, e.sim) for e in heard(later, first=3)]
    assert failed(evidence(due, late)) == set()
    assert failed(evidence(due, heard(later))) == {"counts"}
    too_soon = heard(later, first=3)
    assert failed(evidence(due, too_soon)) == {"rate"}


@pytest.mark.parametrize(
    ("seen", "key", "says", "next_step"),
    [
        ([100 + n for n in range(20)], "counter_step", "must go down by one", "self.charge -= 1"),
        ([100] * 20, "counter_stuck", "contains the number 100", "take 1 from the counter"),
        ([99 - n for n in range(20)], "counter_start", "must begin at 100", "self.charge = 100"),
        ([100 - n for n in range(0, 40, 2)], "counter_step", "After 100 comes 98", "self.charge -= 1"),
    ],
)
def test_a_mistake_is_told_in_the_words_of_what_is_counted(
    seen: list[object], key: str, says: str, next_step: str
) -> None:
    found = evidence(list(DOWN), heard(seen))
    assert failed(found) == {"counts"}
    (name, text, advice) = told(found)
    assert name == key
    assert says in text
    assert next_step in advice
    assert "string" not in advice


def test_the_example_for_a_text_without_its_number_is_the_task_s_own_text() -> None:
    found = evidence([f"{n} %" for n in DOWN], heard(["{self.charge} %"] * 20))
    key, _, advice = told(found)
    assert key == "wrong_text"
    assert "f'{self.charge} %'" in advice


def test_a_reference_that_does_not_count_is_the_author_s_error() -> None:
    with pytest.raises(ValueError, match=r"leave out heard\.counts"):
        failed(evidence(["hello"] * 20, heard(["hello"] * 20)))
