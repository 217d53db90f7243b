"""The talker's criteria on evidence made by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest
from lab_1_2 import talker

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.recipes.published_texts import template
from tests.cases import cases

TOPIC, TYPE = "/chatter", "std_msgs/msg/String"


def _messages(numbers: list[int], period: float, *, first: int = 1, simulated: bool = True) -> list[Event]:
    """Messages as the judge hears them, the first being the publisher's ``first``."""
    return _with_texts([f"Hello, world! {n}" for n in numbers], period, first=first, simulated=simulated)


def _with_texts(texts: list[str], period: float, *, first: int = 1, simulated: bool = True) -> list[Event]:
    return [
        Event(
            t=0.3 + i * period,
            kind="message",
            name=TOPIC,
            data={
                "fields": {"data": text},
                "number": first + i,
                "sent": 50 + i * period,
                "arrived": 50.001 + i * period,
            },
            sim=100 + i * period if simulated else None,
        )
        for i, text in enumerate(texts)
    ]


REFERENCE = Reference(
    "lab_1_2.talker", {"publisher": {TOPIC: TYPE}}, [Part("talking", {}, _messages(list(range(20)), 0.5))]
)


def _evidence(messages: list[Event], *, real_time: bool = False) -> Evidence:
    interface = Event(0.2, "interface", "graph", {"nodes": ["/t"], "publisher": {TOPIC: TYPE}})
    return Evidence([Part("talking", {}, [interface, *messages])], REFERENCE, real_time)


def judged(name: str, evidence: Evidence) -> bool:
    """Whether a criterion holds."""
    return next(c for c in talker.EXERCISE.criteria if c.name == name).judge(evidence).passed


@pytest.mark.parametrize(("ended", "known"), [(None, True), (2.5, True), (0.3, False)])
def test_a_publisher_whose_qos_does_not_fit_was_there_whether_it_goes_on_or_not(
    ended: float | None, known: bool
) -> None:
    misfit = Event(0.24, "mismatch", TOPIC, {"policy": "reliability"})
    exited = [Event(ended, "subject", "exited", {"code": 0})] if ended else []
    seen = _evidence([misfit, *exited])
    assert judged("topic", seen) is known
    assert judged("type", seen) is known


def test_a_first_message_that_nobody_could_hear_is_forgiven() -> None:
    assert judged("counter", _evidence(_messages(list(range(1, 21)), 0.5, first=2)))


def told(key: str, evidence: Evidence) -> str:
    """What is told of a mistake; empty where the evidence does not show it."""
    advice = next(mistake for mistake in talker.EXERCISE.mistakes if mistake.key == key).recognize(evidence)
    return advice.text if advice else ""


@pytest.mark.parametrize(("heard", "number"), [(1, 1), (2, 2), (3, 3)])
def test_a_counter_that_starts_at_one_is_not(heard: int, number: int) -> None:
    """Also where the first messages came before the judge could receive one them."""
    evidence = _evidence(_messages(list(range(heard, heard + 20)), 0.5, first=number))
    assert not judged("counter", evidence)
    assert told("counter_start", evidence) == (
        "The first message contains the number 1, but the counter must begin at 0."
    )


def _started_at(seconds: float, messages: list[Event]) -> list[Event]:
    """The same messages, the first so many seconds after the program's start."""
    late = seconds - messages[0].t
    return [replace(message, t=message.t + late) for message in messages]


@pytest.mark.parametrize(
    ("first", "after", "simulated", "right"),
    cases(__file__, "what_came_before_anybody_could_hear_needs_its_time"),
)
def test_what_came_before_anybody_could_hear_needs_its_time(
    first: int, after: float, simulated: bool, right: bool
) -> None:
    numbers = list(range(first - 1, first + 19))
    heard = _started_at(after, _messages(numbers, 0.5, first=first, simulated=simulated))
    evidence = _evidence(heard, real_time=not simulated)
    assert judged("rate", evidence) is right
    assert judged("counter", evidence)
    assert ("messages in the first" in told("wrong_rate", evidence)) is not right


def test_three_messages_at_once_are_no_beginning() -> None:
    """A notebook's class is heard from its first message on, before there is a simulated clock."""
    burst = [replace(one, sim=None) for one in _messages([0, 1, 2], 0.001)]
    later = _started_at(0.4, _messages(list(range(3, 23)), 0.5, first=4))
    assert not judged("rate", _evidence([*burst, *later]))
    one = _messages(list(range(20)), 0.5)
    assert judged("rate", _evidence([replace(one[0], sim=None), *one[1:]]))


def test_messages_that_were_held_up_while_the_two_ends_met_are_no_burst() -> None:
    talked = _messages(list(range(20)), 0.5, simulated=False)
    arrived = {"arrived": talked[5].data["arrived"]}
    held_up = [replace(one, t=talked[5].t, data={**one.data, **arrived}) for one in talked[:5]]
    assert judged("rate", _evidence([*held_up, *talked[5:]], real_time=True))


def points(evidence: Evidence) -> float:
    return sum(c.points for c in talker.EXERCISE.criteria if c.judge(evidence).passed)


@pytest.mark.parametrize("greeting", ["Talker started", "Talker 7 started", ""])
@pytest.mark.parametrize("before", [1, 2])
def test_a_greeting_costs_the_same_whether_it_was_heard_or_not(greeting: str, before: int) -> None:
    texts = [*[greeting] * before, *(f"Hello, world! {i}" for i in range(20))]
    heard = _evidence(_with_texts(texts, 0.5))
    lost = _evidence(_with_texts(texts[before:], 0.5, first=before + 1))
    assert points(heard) == points(lost) == 8
    assert judged("counter", heard)
    assert not judged("counter", lost)
    more = "1 message" if before == 1 else "2 messages"
    first = f"“Hello, world! 0” was message {before + 1} of your node"
    said = f"{first}. Before it, your node published {more} that did not count"
    assert told("counter_start", heard) == f"{said}: “{greeting}”."
    assert told("counter_start", lost) == f"{said}, before any subscriber was connected."
    assert not told("wrong_text", heard)


def test_a_greeting_with_a_number_longer_than_python_reads_is_a_greeting() -> None:
    """int() refuses more than 4,300 digits (sys.set_int_max_str_digits)."""
    texts = [f"Talker {'7' * 5000}", *(f"Hello, world! {i}" for i in range(20))]
    assert told("counter_start", _evidence(_with_texts(texts, 0.5))).endswith("7”.")


def test_a_greeting_hides_no_wrong_start() -> None:
    texts = ["Talker started", *(f"Hello, world! {i}" for i in range(1, 21))]
    heard = _evidence(_with_texts(texts, 0.5))
    assert not judged("counter", heard)
    assert told("counter_start", heard) == (
        "The first message contains the number 1, but the counter must begin at 0."
    )


def test_another_text_with_a_number_that_leads_on_is_no_greeting() -> None:
    texts = ["hello world 0", *(f"Hello, world! {i}" for i in range(1, 20))]
    assert judged("counter", _evidence(_with_texts(texts, 0.5)))
    assert not judged("text", _evidence(_with_texts(texts, 0.5)))


def _spaced(gaps: list[float], *, simulated: bool = False) -> list[Event]:
    """Messages that are so many seconds apart."""
    moments = [0.0]
    for gap in gaps:
        moments.append(moments[-1] + gap)
    return [
        Event(
            0.3 + t,
            "message",
            TOPIC,
            {"fields": {"data": f"Hello, world! {i}"}, "number": i + 1, "sent": 50 + t, "arrived": 50.01 + t},
            100 + t if simulated else None,
        )
        for i, t in enumerate(moments)
    ]


@pytest.mark.parametrize(("gaps", "right"), cases(__file__, "in_real_time_one_message_in_a_row_may_be_late"))
def test_in_real_time_one_message_in_a_row_may_be_late(gaps: list[float], right: bool) -> None:
    assert judged("rate", _evidence(_spaced(gaps), real_time=True)) is right


@pytest.mark.parametrize(("gaps", "right"), cases(__file__, "in_simulated_time_every_interval_counts"))
def test_in_simulated_time_every_interval_counts(gaps: list[float], right: bool) -> None:
    assert judged("rate", _evidence(_spaced([0.5, *gaps], simulated=True))) is right


@pytest.mark.parametrize(
    ("fast", "slow", "right"),
    [(0.5, 0.5, True), (0.55, 0.502, True), (0.53, 0.531, False), (0.45, 0.451, False), (0.55, 0.55, False)],
)
def test_a_wrong_period_that_both_clocks_show_is_wrong(fast: float, slow: float, right: bool) -> None:
    before = _evidence(_spaced([fast] * 20, simulated=True))
    again = _evidence(_spaced([slow] * 19), real_time=True)
    assert judged("rate", replace(again, before=before)) is right


@pytest.mark.parametrize(("speed", "right"), [(10.0, True), (1.2, True), (0.5, False)])
def test_the_simulated_rate_is_no_matter_of_load_where_that_time_went_by_faster_than_real_time(
    speed: float, right: bool
) -> None:
    """A crowded machine waits for a callback that sleeps for a second, too."""
    exact = _messages(list(range(1, 21)), 0.5)
    before = _evidence([Event(e.t / speed, "message", TOPIC, e.data, e.sim) for e in exact])
    again = _evidence(_spaced([0.62, 0.0, 0.82, 0.18] * 5), real_time=True)
    assert not judged("rate", again)
    assert judged("rate", replace(again, before=before)) is right


def test_who_stumbles_in_simulated_time_is_listened_to_for_longer_in_real_time() -> None:
    before = _evidence(_spaced(([0.5] * 3 + [1.0]) * 5, simulated=True))
    again = _evidence(_spaced(([0.5] * 3 + [1.0]) * 5), real_time=True)
    assert not judged("rate", replace(again, before=before))
    short = _evidence(_spaced([0.5] * 6), real_time=True)
    assert not judged("counter", replace(short, before=_evidence(_spaced([0.5] * 12, simulated=True))))
    assert judged("counter", replace(short, before=_evidence(_spaced([0.5] * 19, simulated=True))))


@pytest.mark.parametrize("speed", [25.0, 2.3, 1.3, 0.4])
@pytest.mark.parametrize("ahead", [0.0, 1.0, -5.0])
def test_times_of_sending_are_not_believed_of_a_clock_that_runs_at_another_speed(
    speed: float, ahead: float
) -> None:
    messages = [
        Event(e.t / speed, "message", TOPIC, {**e.data, "arrived": 50.01 + ahead + 0.5 * i / speed})
        for i, e in enumerate(_spaced([0.5] * 13))
    ]
    assert not judged("rate", _evidence(messages, real_time=True))


def test_a_judge_that_hears_late_believes_the_publisher() -> None:
    late = [0.0, 0.25, 0.02, 0.28, 0.1, 0.0, 0.2]
    messages = [
        Event(e.t + d, "message", TOPIC, {**e.data, "arrived": e.data["arrived"] + d})
        for e, d in zip(_spaced([0.5] * 6), late, strict=True)
    ]
    assert judged("rate", _evidence(messages, real_time=True))


def _step(events: list[Event]) -> str:
    step = next(mistake for mistake in talker.EXERCISE.mistakes if mistake.key == "counter_step")
    advice = step.recognize(_evidence(events))
    return advice.text if advice else ""


def test_a_slip_is_shown_where_it_is() -> None:
    late = _messages([*range(13), *range(14, 21)], 0.5)
    assert _step(late).startswith("After 12 comes 14 (…, 10, 11, 12, 14, 15, 16, …).")
    assert _step(_messages([0, 2, 4, 6, 8, 10, 12], 0.5)).startswith(
        "After 0 comes 2 (0, 2, 4, 6, 8, 10, …)."
    )


@pytest.mark.parametrize(("text", "is_number"), [("0", True), ("10", True), ("00", False), ("007", False)])
def test_a_number_has_no_zeros_in_front(text: str, is_number: bool) -> None:
    assert (template(f"Hello, world! {text}") == "Hello, world! #") is is_number


@pytest.mark.parametrize("arrive", [range(20), range(0, 20, 2), range(3)])
def test_a_publisher_that_is_made_anew_for_each_message_always_costs_the_same_and_is_named(
    arrive: range,
) -> None:
    messages = [
        replace(message, data={**message.data, "number": 1})
        for message in (_messages(list(range(20)), 0.5)[number] for number in arrive)
    ]
    met = [Event(0.3 + i / 2, "matched", TOPIC, {"count": i + 1, "now": 1}) for i in range(20)]
    seen = _evidence(sorted([*met, *messages], key=lambda event: event.t))
    lost = {c.name for c in talker.EXERCISE.criteria if not c.judge(seen).passed}
    assert lost == {"counter", "rate"}
    assert next(m for m in talker.EXERCISE.mistakes if m.recognize(seen)).key == "published_before_discovery"


def test_publishers_that_are_made_at_the_same_moment_are_not_one_after_another() -> None:
    met = [Event(0.31, "matched", TOPIC, {"count": i + 1, "now": i + 1}) for i in range(4)]
    ended = Event(11.0, "matched", TOPIC, {"count": 4, "now": 0})
    seen = _evidence([*met, *_messages(list(range(20)), 0.5), ended])
    assert judged("counter", seen)
    assert judged("rate", seen)
