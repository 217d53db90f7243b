"""From what a judge saw to where it stands in the picture, for pictures that once told something else."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

from autograder.cards.card_traffic import traffic
from autograder.cards.timeline_layout import HALF_WIDTH, TURNS, WIDTH, picture
from autograder.judge.timeline.verdict_timeline import moments
from autograder.kit.evidence import Event, Evidence, Part, Reference
from tests.cards.test_timeline_layout import assert_legible

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.cards.timeline_layout import Mark, Picture

AT_MOST = 60
"""Moments that a card shows."""
ACTION = "/fibonacci"


def drawn(events: Iterable[Event], width: int, interface: dict[str, dict[str, str]] | None = None) -> Picture:
    evidence = Evidence([Part("", {}, tuple(events))], Reference("an exercise", interface or {}, ()))
    (part,) = traffic(moments(evidence), at_most=AT_MOST).parts
    found = picture(part, width)
    assert_legible(found, width)
    return found


def marks(found: Picture, lane: str) -> tuple[Mark, ...]:
    (marks,) = (one.marks for one in found.lanes if one.name.replace("\u200b", "") == lane)
    return tuple(marks)


both_widths = pytest.mark.parametrize("width", [WIDTH, HALF_WIDTH])


@both_widths
def test_a_talker_that_is_on_time_looks_so(width: int) -> None:
    """A message at 0.000 s once stood at 0.09 s, and a log line before its message."""
    beats = [0.5 * beat for beat in range(8)]
    found = drawn(
        [
            event
            for t in beats
            for event in (
                Event(t, "message", "/chatter", {"fields": {"data": f"Hello, world! {t * 2:g}"}}),
                Event(t, "log", "talker", {"text": f"Publishing {t * 2:g}"}),
            )
        ],
        width,
    )
    messages, lines = marks(found, "/chatter"), marks(found, "log")
    steps = [right.x - left.x for left, right in pairwise(messages)]
    assert max(steps) - min(steps) < 0.05
    assert messages[0].x == next(tick.x for tick in found.ticks if tick.text == "0 s")
    assert [mark.x for mark in lines] == [mark.x for mark in messages]


@both_widths
def test_what_a_listener_heard_at_one_time_has_an_order_and_no_seconds(width: int) -> None:
    """Moments that were all at 0.000 s were once spread over an axis from 0.0 to 1.5 ms."""
    found = drawn(
        (
            event
            for number in range(6)
            for event in (
                Event(0.01 * number, "sent", "/chatter", {"fields": {"data": f"text {number}"}}, 7.0),
                Event(0.01 * number + 0.005, "log", "listener", {"text": f"I heard {number}"}, 7.0),
            )
        ),
        width,
    )
    assert [tick.text for tick in found.ticks] == [TURNS]
    xs = sorted((*marks(found, "/chatter"), *marks(found, "log")), key=lambda mark: mark.x)
    assert [mark.x for mark in xs[::2]] == [mark.x for mark in marks(found, "/chatter")]


@both_widths
@pytest.mark.parametrize("often", [1, 2, 12])
def test_every_cancel_request_is_labelled(width: int, often: int) -> None:
    """The cancel request, the point of Exercise 1.3, once had no label."""
    events = [Event(0.0, "goal", ACTION, {"fields": {"order": 20}})]
    for number in range(20):
        t = 0.5 * (number + 1)
        events.append(Event(t, "feedback", ACTION, {"fields": {"partial_sequence": list(range(number))}}))
        if 3 <= number < 3 + often:
            events.append(Event(t + 0.002, "cancel", ACTION, {"accepted": True, "known": True}))
    events.append(Event(11.0, "result", ACTION, {"status": "canceled", "fields": {"sequence": [0, 1, 1, 2]}}))
    labels = [mark.label for mark in marks(drawn(events, width), ACTION)]
    assert labels.count("cancel request") == often
    assert any(label == "goal, order 20" for label in labels)
    assert labels[-1].startswith("CANCELED")


@both_widths
def test_two_goals_have_a_lane_each_and_a_status_its_name(width: int) -> None:
    """25 triangles of two goals once stood in one lane, with five labels and "status 5"."""
    events = [
        Event(0.0, "goal_sent", ACTION, {"goal": 0, "fields": {"order": 12}}),
        Event(0.1, "goal_sent", ACTION, {"goal": 1, "fields": {"order": 12}}),
        *(
            Event(0.2 + 0.1 * n, "feedback_heard", ACTION, {"goal": n % 2, "fields": {"sequence": [n]}})
            for n in range(25)
        ),
        Event(2.8, "cancel_sent", ACTION, {"goal": 0}),
        Event(2.9, "result_heard", ACTION, {"goal": 0, "status": 5, "fields": {"sequence": [0, 1]}}),
        Event(3.0, "result_heard", ACTION, {"goal": 1, "status": 4, "fields": {"sequence": [0, 1]}}),
    ]
    found = drawn(events, width)
    one, two = marks(found, f"{ACTION}, goal 1"), marks(found, f"{ACTION}, goal 2")
    assert one[-1].label.startswith("CANCELED")
    assert two[-1].label.startswith("SUCCEEDED")
    assert "status" not in " ".join(mark.label + mark.tooltip for mark in (*one, *two))


@both_widths
def test_what_the_judge_sent_itself_comes_from_the_judge(width: int) -> None:
    """Exercise 1.1 once told the judge's own "status 16836" as "from your code"."""
    fields = {"fields": {"data": "status 16836"}}
    found = drawn([Event(0.1, "sent", "/status", fields), Event(0.2, "message", "/status", fields)], width)
    (only,) = marks(found, "/status")
    assert only.direction == "to_subject"


@both_widths
def test_a_wrong_topic_is_in_the_picture_beside_the_right_one(width: int) -> None:
    """The picture was once empty, although the judge knew of /chater."""
    survey = Event(0.4, "interface", "graph", {"publisher": {"/chater": "std_msgs/msg/String"}})
    found = drawn([survey], width, {"publisher": {"/chatter": "std_msgs/msg/String"}})
    (wrong,), (right,) = marks(found, "/chater"), marks(found, "/chatter")
    assert wrong.stray
    assert not right.stray
    assert wrong.label
    assert right.label
