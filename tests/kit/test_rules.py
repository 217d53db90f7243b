"""A rule on how things are as a criterion, and wrong rules as mistakes."""

from __future__ import annotations

from typing import Any

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.rules import Given, State, StateRule, same


@pytest.mark.parametrize(
    ("made", "due", "passes"),
    [
        (0.1 + 0.2, 0.3, True),
        (0.31, 0.3, False),
        ({"x": 0.1 + 0.2, "name": "a"}, {"x": 0.3, "name": "a"}, True),
        ({"x": 0.3}, 0.3, False),
        (2**62 + 1, 2**62, False),
        ("a", 0.3, False),
    ],
)
def test_contents_are_the_same_but_for_what_rounding_takes(made: Any, due: Any, passes: bool) -> None:
    assert same(made, due) is passes


def within(limit: float) -> State:
    return lambda beats: any(beat.age <= limit for beat in beats)


WATCH = StateRule(within(1.0))
ALIVE, SILENT = WATCH.when(within(1.0)), WATCH.when(lambda beats: not within(1.0)(beats))
MOMENTS = [n / 2 for n in range(1, 13)]


def watch(says: State | None, moments: list[float] = MOMENTS) -> Part:
    """One heartbeat at 2.1 s; what ``says`` makes of it at some moments, or a node that speaks only when it comes."""
    beat = Event(9.9, "sent", "/heartbeat", {"fields": {}}, sim=2.1)
    if says is None:
        return Part("met", {}, [beat, Event(9.9, "message", "/alive", {"fields": {"data": True}}, sim=2.1)])
    said = [
        Event(
            9.9,
            "message",
            "/alive",
            {"fields": {"data": says([Given(m - 2.1, {}, "/heartbeat")] * (m > 2.1))}},
            m,
        )
        for m in moments
    ]
    return Part("met", {}, sorted([beat, *said], key=lambda event: event.moment))


@pytest.mark.parametrize(
    ("says", "alive", "silent", "latched", "at_once"),
    [
        (within(1.0), True, True, False, False),
        (within(1.1), True, True, False, False),
        (within(3.0), True, False, False, False),
        (bool, True, False, True, False),
        (lambda _: True, True, False, False, False),
        (lambda _: False, False, True, False, False),
        (None, False, False, False, True),
    ],
    ids=[
        "right",
        "late, within the slack",
        "too patient",
        "latched",
        "always",
        "never",
        "only when it comes",
    ],
)
def test_what_is_said_is_compared_with_what_is_due_then(
    says: State | None, alive: bool, silent: bool, latched: bool, at_once: bool
) -> None:
    seen, expected = watch(says), watch(within(1.0))
    assert (ALIVE(seen, expected).passed, SILENT(seen, expected).passed) == (alive, silent)
    assert WATCH.taken_for(bool)(seen, expected) is latched
    assert WATCH.only_in_answer(seen, expected) is at_once


def test_who_says_nothing_at_such_times_has_not_said_the_right_thing() -> None:
    seen = watch(within(1.0), moments=[0.5])
    finding = SILENT(seen, watch(within(1.0)))
    assert (finding.passed, finding.expected, finding.seen) == (False, "False", "1 message at such times")


def test_the_card_says_how_often_another_thing_was_said() -> None:
    finding = SILENT(watch(bool), watch(within(1.0)))
    assert (finding.expected, finding.seen) == ("False", "True in 6 of 10 messages")


def test_in_real_time_a_message_is_of_the_moment_in_which_it_was_sent() -> None:
    late = {"fields": {"data": True}, "sent": 1000.0, "arrived": 1000.3}
    events = [Event(2.0, "sent", "/heartbeat", {"fields": {}}), Event(3.3, "message", "/alive", late)]
    assert SILENT(Part("met", {}, events), watch(within(1.0))).seen == "0 messages at such times"
