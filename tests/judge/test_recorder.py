"""What the judge writes down, and how it waits for it."""

from __future__ import annotations

import threading

from autograder.judge import recorder
from autograder.judge.recorder import Recorder


def test_events_keep_their_order_and_their_data_as_it_was() -> None:
    book = Recorder()
    book.begin("part", {"a": 1})
    numbers = [1]
    book.record("message", "/chatter", fields=numbers)
    numbers.append(2)
    book.record("log", "talker", text="hello")
    part = book.part()
    assert [event.kind for event in part.events] == ["message", "log"]
    assert part.events[0].data["fields"] == [1]
    assert part.inputs == {"a": 1}


def test_a_new_part_forgets_the_one_before() -> None:
    book = Recorder()
    book.begin("one", {})
    book.record("log", "x", text="old")
    book.begin("two", {})
    assert book.part().events == ()


def test_waiting_ends_at_the_event_and_not_at_the_limit() -> None:
    book = Recorder()
    book.begin("part", {})
    threading.Timer(0.02, lambda: book.record("goal", "/fibonacci")).start()
    assert book.wait(lambda: bool(book.part().of("goal")), within=60.0, poll=60.0)


def test_waiting_gives_up_at_its_limit() -> None:
    book = Recorder()
    book.begin("part", {})
    assert not book.wait(lambda: False, within=0.01)


def test_a_flood_is_cut(monkeypatch: object) -> None:
    book = Recorder()
    book.begin("part", {})
    for number in range(recorder.MAX_EVENTS + 5):
        book.record("message", "/flood", number=number)
    assert len(book.part().events) == recorder.MAX_EVENTS
