"""A subject may serve its parameters itself, and answer what no node of rclpy answers."""

from __future__ import annotations

from typing import Any

import pytest

from autograder.kit.evidence import Event
from autograder.kit.oracle.parameter_answers import described, parameter_in_words, received
from tests.cases import cases

ONE = {"type": 3, "floating_point_range": [{"from_value": 0.0, "to_value": 2.0}], "integer_range": []}
TAKEN: dict[str, Any] = {"successful": True, "reason": ""}


def answered(service: str, **fields: object) -> list[Event]:
    """Return the answer of a service of the node, after that of another service."""
    other = Event(0.1, "answered", "/other", {"fields": {"success": True}})
    return [other, Event(0.2, "answered", f"/limits/{service}", {"fields": fields}), other]


@pytest.mark.parametrize(("descriptors", "words"), cases(__file__, "a_description_is_noted_whatever_it_is"))
def test_a_description_is_noted_whatever_it_is(descriptors: list[Any], words: str) -> None:
    assert parameter_in_words(described(answered("describe_parameters", descriptors=descriptors))) == words


@pytest.mark.parametrize(
    ("results", "words"), cases(__file__, "what_became_of_a_value_is_noted_whatever_it_is")
)
def test_what_became_of_a_value_is_noted_whatever_it_is(results: list[Any], words: str) -> None:
    assert parameter_in_words(received(answered("set_parameters", results=results))) == words


def test_an_answer_that_is_missing_from_the_record_differs_from_each_other_one() -> None:
    assert received([]) == ["0 results for one value"]
    assert described([]) == [0, []]
