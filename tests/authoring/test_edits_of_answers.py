"""Texts stored as edits: what they make of their base, and what is said where they do not fit it."""

from __future__ import annotations

import pytest

from autograder.authoring.answer_tables import CannotEdit, edited_text
from tests.cases import cases, named_cases

BASE = cases(__file__, "BASE")


@pytest.mark.parametrize(("change", "old", "new"), named_cases(__file__, "a_change_is_made"))
def test_a_change_is_made(change: str, old: str, new: str) -> None:
    assert edited_text(BASE, change) == BASE.replace(old, new)


def test_several_places_are_changed_in_any_order() -> None:
    places = ["-    node = make()\n+    node = take()", "-import rclpy\n+import rclpy as ros"]
    there = BASE.replace("make", "take").replace("import rclpy", "import rclpy as ros")
    assert edited_text(BASE, "\n...\n".join(places)) == there
    assert edited_text(BASE, "\n...\n".join(reversed(places)) + "\n") == there


@pytest.mark.parametrize(("change", "words"), named_cases(__file__, "what_does_not_fit_is_said"))
def test_what_does_not_fit_is_said(change: str, words: str) -> None:
    with pytest.raises(CannotEdit, match=words):
        edited_text(BASE, change)
