"""What the judge writes down, and how it waits for it."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest

from autograder.judge import machine_fitness
from autograder.judge.bench import recorder
from autograder.judge.bench.recorder import Recorder
from autograder.judge.bench.unreadable import FLOOD, UnreadableSubject
from autograder.judge.machine_fitness import SLOWEST, Patience


def test_events_keep_their_order_and_their_data_as_it_was() -> None:
    book = Recorder("part", {"a": 1})
    numbers = [1]
    book.record("message", "/chatter", fields=numbers)
    numbers.append(2)
    book.record("log", "talker", text="hello")
    part = book.part()
    assert [event.kind for event in part.events] == ["message", "log"]
    assert part.events[0].data["fields"] == [1]
    assert part.inputs == {"a": 1}


def test_waiting_ends_at_the_event_and_not_at_the_limit() -> None:
    book = Recorder()
    threading.Timer(0.02, lambda: book.record("goal", "/fibonacci")).start()
    assert book.wait(lambda: bool(book.part().of("goal")), within=60.0, poll=60.0)


def test_waiting_gives_up_at_its_limit() -> None:
    book = Recorder()
    assert not book.wait(lambda: False, within=0.01)


def test_silence_ends_the_wait_and_every_event_puts_it_off() -> None:
    book = Recorder()
    asked: list[int] = []

    def speak_at_first() -> bool:
        asked.append(len(asked))
        if len(asked) < 20:
            book.record("log", "x", text="going on")
        return False

    assert not book.wait(speak_at_first, within=60.0, quiet=0.05)
    assert len(asked) > 20


@pytest.mark.parametrize(("wall", "slowness"), [(False, SLOWEST), (True, 1.0)])
def test_a_crowded_machine_gives_more_time_and_the_judges_own_pace_stays(
    monkeypatch: pytest.MonkeyPatch, wall: bool, slowness: float
) -> None:
    made: list[Patience] = []

    def noted(seconds: float, **how: Any) -> Patience:
        made.append(Patience(seconds, **how))
        return made[-1]

    monkeypatch.setattr(machine_fitness, "machine_slowness", lambda: SLOWEST)
    monkeypatch.setattr(recorder, "Patience", noted)
    Recorder().wait(lambda: True, within=5.0, quiet=1.0, wall=wall)
    assert [one.slowness() for one in made] == [slowness, slowness]


def test_a_flood_is_cut(monkeypatch: object) -> None:
    book = Recorder()
    for number in range(recorder.MAX_EVENTS + 5):
        book.record("message", "/flood", number=number)
    assert len(book.part().events) == recorder.MAX_EVENTS + 1
    # What a scenario waits for now may be missing from the record, so no scenario goes on.
    with pytest.raises(UnreadableSubject, match=FLOOD):
        book.wait(lambda: True, 0.0)


@pytest.mark.parametrize("kind", ["output", "request"])
def test_a_flood_of_words_fills_no_record(kind: str) -> None:
    book = Recorder()
    for _ in range(recorder.MAX_EVENTS):
        book.record("output", "stdout", text="")
    book.record(kind, "last", text="")
    assert book.wait(lambda: book.part().events[-1].name == "last", 0.0)


@pytest.mark.parametrize("text", ["", "a line", "x" * 1000])
def test_what_was_said_behind_a_line_that_was_dropped_is_what_is_kept(text: str) -> None:
    book = Recorder()
    book.record("output", "stdout", text=text)
    first = book.part().events[0]
    for _ in range(recorder.MAX_EVENTS + 5):
        book.record("output", "stdout", text=text)
    assert first not in book.part().events
    assert book.part().said(after=first) == book.part().said()


def test_of_long_speech_the_end_is_kept_and_all_else_too() -> None:
    book = Recorder()
    book.record("request", "/add_two_ints", fields={"a": 1, "b": 2})
    book.record("output", "notebook", text="@workspace {}")
    for number in range(300):
        book.record("output", "notebook", text=f"{number} " + "x" * 10_000)
    part = book.part()
    assert part.first("request") is not None
    assert [e for e in part.of("output") if e.data["text"].startswith("@workspace")]
    assert part.of("output")[-1].data["text"].startswith("299 ")
    assert sum(len(e.data["text"]) for e in part.of("output")) <= recorder.MAX_SAID


def test_huge_messages_are_cut() -> None:
    book = Recorder()
    book.record("looked", "list", fields=[1] * (recorder.MAX_TEXT + 5))
    text = "x" * 4_000_000
    for _ in range(recorder.MAX_TEXTS // recorder.MAX_TEXT + 5):
        book.record("message", "/chatter", fields={"data": text})
    (looked,) = book.part().of("looked")
    assert len(looked.data["fields"]) <= recorder.MAX_TEXT + 1
    texts = [e.data["fields"]["data"] for e in book.part().of("message")]
    assert len(texts[0]) == recorder.MAX_TEXT + 1
    assert len(texts[-1]) == recorder.BEGINNING + 1


def test_of_lists_of_small_items_no_more_is_kept_than_of_texts() -> None:
    book = Recorder()
    for _ in range(20):
        book.record("subject", "started", accepted=[""] * recorder.MAX_TEXT)
    kept = [len(event.data["accepted"]) for event in book.part().events]
    assert kept[0] == recorder.MAX_TEXT
    assert kept[-1] == recorder.BEGINNING
    assert sum(kept) * recorder.ITEM < 2 * recorder.MAX_TEXTS


def test_what_is_no_text_can_be_written_down_all_the_same() -> None:
    book = Recorder()
    book.record("output", "notebook", text="Grüße \ud800")
    (event,) = book.part().events
    assert event.data["text"].encode() == "Grüße ?".encode()


def test_an_end_is_behind_all_that_was_sent_before_and_keeps_its_moment() -> None:
    book, ended = Recorder(), threading.Event()

    def take_in() -> None:
        time.sleep(0.01)
        book.record("request", "/sent")

    book.take_in = take_in
    book.end("exited", ended.set, code=0)
    request, end = book.part().events
    assert (request.kind, end.kind, end.name, end.data) == ("request", "subject", "exited", {"code": 0})
    assert end.t < request.t
    assert ended.is_set()
