"""How many there were, and where two texts differ, in words."""

from __future__ import annotations

import pytest

from autograder.kit.in_words import counted, first_difference

LINE = "Hello, ROS 2! From SimpleNode."


@pytest.mark.parametrize(("number", "words"), [(0, "0 messages"), (1, "1 message"), (2, "2 messages")])
def test_one_is_not_many(number: int, words: str) -> None:
    assert counted(number, "message") == words


@pytest.mark.parametrize(
    ("said", "words"),
    [
        (LINE, ""),
        (
            "Hello, ROS 2! from SimpleNode.",
            "After “Hello, ROS 2! ” the task has “From SimpleNode.”, and yours has “from SimpleNode.”.",
        ),
        (
            "Hello, ROS 2! From SimpleNode",
            "After “ From SimpleNode” the task has “.”, and yours has nothing more.",
        ),
        (LINE + "!", "After “From SimpleNode.” the task has nothing more, and yours has “!”."),
        ("hello", "At the beginning the task has “Hello, ROS 2! Fr”, and yours has “hello”."),
    ],
)
def test_the_first_difference_is_quoted_from_both(said: str, words: str) -> None:
    told = first_difference(said, LINE)
    assert told.startswith(words)
    assert bool(told) == bool(words)
