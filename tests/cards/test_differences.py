"""The difference of two texts: the missing characters and the needless ones."""

from __future__ import annotations

import pytest

from autograder.cards.card_content import difference, marked
from autograder.verdict import CriterionResult
from tests.cases import cases


def between(expected: str, seen: str, *, passed: bool = False) -> str:
    return marked(difference(CriterionResult("text", "Text", 1.0, passed, expected, seen)))


@pytest.mark.parametrize(("seen", "shown"), cases(__file__, "shows_what_is_missing_and_what_is_too_much"))
def test_shows_what_is_missing_and_what_is_too_much(seen: str, shown: str) -> None:
    assert between("“Hello, world! 0”, “Hello, world! 1”, …", seen) == shown


def test_has_nothing_to_say_of_what_holds() -> None:
    assert between("“a b c d”", "“a b c”", passed=True) == ""


def test_the_place_of_a_number_is_no_difference_where_a_number_is() -> None:
    assert between("“holds at N percent”", "“hold at 11 percent”") == "hold[s] at 11 percent"
    assert between("“holds at N”", "“holds at n”") == "holds at [N]{n}"


def test_long_texts_are_not_compared() -> None:
    assert between(f"“{'ab' * 5000}”", f"“{'ab' * 4999}”") == ""
