"""A rule as a criterion, and wrong rules as mistakes."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.rules import Rule

RULE = Rule[Part, int, int](
    lambda seen: list(seen.inputs.get("numbers", ())),
    lambda seen: [event.data["fields"]["data"] for event in seen.of("message")],
    lambda numbers: [2 * number for number in numbers],
)
SQUARED = RULE.taken_for(lambda numbers: [number**2 for number in numbers])


def run(given: list[int], made: list[int]) -> Part:
    events = [Event(0.0, "message", "/twice", {"fields": {"data": number}}) for number in made]
    return Part("doubling", {"numbers": given}, events)


@pytest.mark.parametrize(
    ("given", "made", "passes", "is_squared"),
    [
        ([2, 3], [4, 6], True, False),
        ([2, 3], [4, 9], False, True),
        ([2, 3], [4], False, False),
        ([3, 2], [9], False, True),
        ([2, 3], [4, 9, 9], False, False),
        ([2, 3], [], False, False),
        ([], [], False, False),
    ],
    ids=[
        "right",
        "wrong",
        "right so far",
        "wrong so far",
        "more than the rule makes",
        "nothing made",
        "nothing given",
    ],
)
def test_what_was_made_is_compared_as_far_as_it_goes(
    given: list[int], made: list[int], passes: bool, is_squared: bool
) -> None:
    seen = run(given, made)
    assert (RULE.finding(seen, seen).passed, SQUARED(seen, seen)) == (passes, is_squared)


def test_the_card_says_what_was_due_and_what_came() -> None:
    seen = run([2, 3], [4])
    finding = RULE.finding(seen, seen)
    assert (finding.expected, finding.seen) == ("4, 6", "4")


def test_where_nothing_was_given_the_card_says_what_the_reference_made() -> None:
    finding = RULE.finding(run([], []), run([2, 3], [4, 6]))
    assert (finding.passed, finding.expected, finding.seen) == (False, "such as 4, 6", "nothing")
