"""The talker's criteria on evidence made by hand."""

from __future__ import annotations

import pytest

from autograder.exercises import lab_1_2_talker as talker
from autograder.exercises.evidence import Event, Evidence, Part, Reference

TOPIC, TYPE = "/chatter", "std_msgs/msg/String"


def _messages(numbers: list[int], period: float, *, first: int = 1, simulated: bool = True) -> list[Event]:
    """Messages as the judge hears them, the first being the publisher's ``first``."""
    return [
        Event(
            t=0.3 + i * period,
            kind="message",
            name=TOPIC,
            data={"fields": {"data": f"Hello, world! {n}"}, "number": first + i, "sent": 50 + i * period},
            sim=100 + i * period if simulated else None,
        )
        for i, n in enumerate(numbers)
    ]


REFERENCE = Reference(
    "lab_1_2.talker", {"publisher": {TOPIC: TYPE}}, [Part("talking", {}, _messages(list(range(8)), 0.5))]
)


def _evidence(messages: list[Event], *, real_time: bool = False) -> Evidence:
    interface = Event(0.2, "interface", "graph", {"nodes": ["/t"], "publisher": {TOPIC: TYPE}})
    return Evidence([Part("talking", {}, [interface, *messages])], REFERENCE, real_time)


def test_the_reference_itself_passes() -> None:
    evidence = _evidence(_messages(list(range(8)), 0.5))
    assert all(criterion.judge(evidence).passed for criterion in talker.EXERCISE.criteria)


def test_a_first_message_that_nobody_could_hear_is_forgiven() -> None:
    assert talker.counts_from_zero(_evidence(_messages(list(range(1, 9)), 0.5, first=2))).passed


def test_a_counter_that_starts_at_one_is_not() -> None:
    evidence = _evidence(_messages(list(range(1, 9)), 0.5, first=1))
    assert not talker.counts_from_zero(evidence).passed
    assert talker.counter_start(evidence) is not None


@pytest.mark.parametrize(
    ("period", "right"), [(0.5, True), (0.55, True), (0.45, True), (1.0, False), (0.1, False)]
)
def test_the_rate_is_judged_by_the_median(period: float, right: bool) -> None:
    messages = _messages(list(range(7)), period, simulated=False)
    late = Event(
        messages[3].t, "message", TOPIC, {**messages[3].data, "sent": messages[3].data["sent"] + 0.3}
    )
    assert (
        talker.keeps_the_rate(_evidence([*messages[:3], late, *messages[4:]], real_time=True)).passed is right
    )


def test_one_that_stops_too_soon_does_not_count_on() -> None:
    assert not talker.counts_from_zero(_evidence(_messages([0, 1, 2, 3], 0.5))).passed


def test_nothing_heard_is_nothing_earned() -> None:
    silent = Evidence([Part("talking")], REFERENCE)
    assert not any(criterion.judge(silent).passed for criterion in talker.EXERCISE.criteria)


@pytest.mark.parametrize(("took", "right"), [(3.0, True), (1.8, True), (0.3, False)])
def test_times_of_sending_are_believed_where_the_messages_took_as_long_to_arrive(
    took: float, right: bool
) -> None:
    messages = [
        Event(0.3 + i * took / 6, "message", TOPIC, event.data)
        for i, event in enumerate(_messages(list(range(7)), 0.5, simulated=False))
    ]
    assert talker.keeps_the_rate(_evidence(messages, real_time=True)).passed is right
