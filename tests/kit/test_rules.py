"""When two contents are the same."""

from __future__ import annotations

from typing import Any

import pytest

from autograder.kit.rules import same, value_of
from tests.cases import cases


@pytest.mark.parametrize(
    ("made", "due", "passes"),
    [
        *cases(__file__, "contents_are_the_same_but_for_what_rounding_takes"),
        (2**62 + 1, 2**62, False),
        (10**400, 0.3, False),
        (0.3, -(10**400), False),
        (float("nan"), 10**400, False),
    ],
)
def test_contents_are_the_same_but_for_what_rounding_takes(made: Any, due: Any, passes: bool) -> None:
    assert same(made, due) is passes


def test_not_a_number_is_itself_and_a_tolerance_may_be_given() -> None:
    nan = float("nan")
    assert same([nan], [nan])
    assert not same(nan, 1.0)
    assert same(1.0, 1.05, 0.1)
    assert not same(1.0, 1.05)


HOSTILE = (
    "",
    "[",
    "{[]: 1}",
    "[" * 5000,
    "-" * 40_000 + "1",
    "1+" * 20_000 + "1",
    "9" * 5000,
    "0x" + "f" * 9000,
    "\0",
)
"""Texts that Python cannot read as a value, each for another reason."""


@pytest.mark.parametrize("text", HOSTILE)
def test_a_text_that_stands_for_no_value_is_none(text: str) -> None:
    assert value_of(text) is None
    assert value_of("[1, 2.5, 'a', None]") == [1, 2.5, "a", None]
