"""Two recordings of one behavior are the same whatever chance decided; each other difference is said in words."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from autograder.judge.recording_differences import differences
from autograder.kit.evidence import Event, Part, Reference, Variant

if TYPE_CHECKING:
    from collections.abc import Sequence

COMMANDS, STATES = ("/cmd_vel", [0.2, 0.5, 0.5]), ("/state", [1, 2, 2])


def messages(
    *topics: tuple[str, Sequence[Any]], times: Sequence[float | None] = (0.0, 0.5, 1.0)
) -> list[Event]:
    """Return a message of each topic at each time, in the order of the topics."""
    return [
        Event(0.0, "message", topic, {"fields": {"data": values[number]}}, sim)
        for number, sim in enumerate(times)
        for topic, values in topics
    ]


def recording(events: Sequence[Event], **more: Any) -> Reference:
    """Return a recording in one part, with a wrong answer that did the same."""
    parts = [Part("driving", {}, events)]
    return replace(
        Reference("a.b", {"publisher": {"/state": "x/msg/Y"}}, parts, [Variant("late", "A", "B", parts)]),
        **more,
    )


STORED = recording(messages(COMMANDS, STATES))


@pytest.mark.parametrize(
    "events",
    [
        pytest.param(messages(STATES, COMMANDS), id="two topics in the other order"),
        pytest.param(
            messages(COMMANDS, STATES, times=(None, 0.0, 0.5)), id="a first message without simulated time"
        ),
        pytest.param(
            messages(COMMANDS, STATES, times=(0.0, 0.3, 0.85)), id="a first interval that the jump shortened"
        ),
        pytest.param(messages(("/cmd_vel", [0.2, 0.5, 0.5001]), STATES), id="a number within the tolerance"),
    ],
)
def test_what_chance_decides_is_no_difference(events: Sequence[Event]) -> None:
    assert list(differences(STORED, recording(events), 1e-3)) == []


@pytest.mark.parametrize(
    ("events", "said"),
    [
        (
            messages(COMMANDS, ("/state", [1, 3, 2])),
            'driving, message /state, number 2: {"fields": {"data": 2}} before, {"fields": {"data": 3}} now',
        ),
        (messages(COMMANDS), "driving, message /state: 3 times before, 0 times now"),
        (
            messages(COMMANDS, STATES, times=(0.0, 0.5, 1.25)),
            "driving, message /cmd_vel: number 3 came 0.5 s after the second before, 0.75 s now",
        ),
    ],
)
def test_the_first_difference_of_a_topic_is_said(events: Sequence[Event], said: str) -> None:
    lines = list(differences(STORED, recording(events), 1e-3))
    assert said in lines
    assert f"late, {said}" in lines


def test_a_difference_names_the_step_of_a_scenario() -> None:
    def noted(value: float) -> Reference:
        return recording([Event(0.0, "noted", "/state", {"step": 3, "given": "/scan", "values": [[value]]})])

    line = next(differences(noted(0.2), noted(0.0), 1e-3))
    assert "number 1, step 3, given /scan: " in line
    assert line.endswith('{"values": [[0.2]]} before, {"values": [[0.0]]} now')


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"interface": {}}, "the solution's endpoints: "),
        ({"parts": []}, 'the parts: ["driving"] before, [] now'),
        ({"variants": []}, 'the recorded wrong answers: ["late"] before, [] now'),
        (
            {"variants": [replace(STORED.variants[0], text="C")]},
            'late: the card: ["A", "B"] before, ["C", "B"] now',
        ),
    ],
)
def test_what_stands_around_the_events_is_compared_too(changed: dict[str, Any], said: str) -> None:
    (line,) = differences(STORED, replace(STORED, **changed), 1e-3)
    assert line.startswith(said)
