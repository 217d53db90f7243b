"""How many there were, and where two texts differ, in words."""

from __future__ import annotations

import pytest

from autograder.kit.in_words import counted, first_difference, of_its_kind, shortened, visible
from tests.cases import cases

LINE = "Hello, ROS 2! From SimpleNode."


@pytest.mark.parametrize(("number", "words"), [(0, "0 messages"), (1, "1 message"), (2, "2 messages")])
def test_one_is_not_many(number: int, words: str) -> None:
    assert counted(number, "message") == words


@pytest.mark.parametrize(("said", "words"), cases(__file__, "the_first_difference_is_quoted_from_both"))
def test_the_first_difference_is_quoted_from_both(said: str, words: str) -> None:
    told = first_difference(said, LINE)
    assert told.startswith(words)
    assert bool(told) == bool(words)


def test_a_space_that_looks_like_another_is_shown_by_its_escape() -> None:
    assert visible("Hello,\u00a0world! é 日\n\t") == "Hello,\\xa0world! é 日\\n\\t"


@pytest.mark.parametrize(
    ("in_a_notebook", "words"), cases(__file__, "a_sentence_for_the_other_kind_of_answer_is_left_out")
)
def test_a_sentence_for_the_other_kind_of_answer_is_left_out(in_a_notebook: bool, words: str) -> None:
    text = "Look. In a notebook, call start_ros(). In a program, write it. Go on."
    assert of_its_kind(text, in_a_notebook) == words


@pytest.mark.parametrize("in_a_notebook", [True, False])
def test_nothing_else_is_left_out(in_a_notebook: bool) -> None:
    text = "Stop the notebook. It is a program, and in a program, or in a notebook, this holds. Done."
    assert of_its_kind(text, in_a_notebook) == text


def test_nothing_is_left_of_a_text_for_the_other_kind() -> None:
    assert of_its_kind("In a program, a.b is c. In a program, go!", True) == ""


def test_a_long_list_keeps_its_ends() -> None:
    numbers = list(range(-1, 12))
    assert shortened(f"“said” {numbers}.") == "“said” [-1, 0, 1, 2, 3, …, 10, 11]."
    assert shortened(f"said {[*numbers, 12]}.") == "said [-1, 0, 1, 2, 3, …, 11, 12]."
    assert shortened(f"“said” {numbers[1:]}.") == f"“said” {numbers[1:]}."
