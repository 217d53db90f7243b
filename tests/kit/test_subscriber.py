"""Diagnoses of a listener, from what it was sent and what it said."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.recipes.subscriber import Subscriber
from autograder.kit.reported_texts import AT_PACE, PAIRS, TRIES, drawn_pairs, random_texts

TEXTS = ("amber birch 1234", "cedar delta 5678", "ember fjord 9012")
REFERENCE = Reference("x", {"subscription": {"/chatter": "std_msgs/msg/String"}})


def seen(*heard: tuple[str, list[str]]) -> Evidence:
    """Return the evidence of a listener that said these lines after each of the texts."""
    events = [Event(0.0, "interface", "", dict(REFERENCE.interface))]
    for text, lines in heard:
        events.append(Event(1.0, "sent", "/chatter", {"fields": {"data": text}}, sim=1.0))
        events += [Event(1.1, "output", "stdout", {"text": line}) for line in lines]
    return Evidence([Part("listening", {"texts": list(TEXTS)}, events)], REFERENCE)


def told(key: str, evidence: Evidence) -> str:
    """Return all words of the diagnosis with this key; empty if it does not fit."""
    ladder = [mistake for mistake in Subscriber(pace=0.5, paced_by="a talker").ladder if mistake.key == key]
    found = next(filter(None, (mistake.recognize(evidence) for mistake in ladder)), None)
    return f"{found.text} {found.next_step}" if found else ""


@pytest.mark.parametrize(
    ("times", "words"), [((2, 2, 2), "2 times for one message"), ((2, 1, 2), "2 times"), ((1, 1, 1), "")]
)
def test_what_is_said_again_is_told_with_its_count(times: tuple[int, ...], words: str) -> None:
    lines = ((text, [f"heard {text}"] * often) for text, often in zip(TEXTS, times, strict=True))
    card = told("everything_twice", seen(*lines))
    assert (words in card) if words else not card


def test_empty_lines_are_no_words() -> None:
    assert "prints nothing when" in told("not_logged", seen((TEXTS[0], [""]), (TEXTS[1], ["", " "])))
    assert "said “hello”" in told("not_logged", seen((TEXTS[0], ["", "hello"])))


class Bench:
    """A bench without a listener, which tells what the recipe does."""

    pace = Pace.FAST

    def __init__(self, texts: list[str], pairs: list[str]) -> None:
        self.done: list[str] = []
        self._part = Part("listening", {"texts": texts, "pairs": pairs})

    def seen(self) -> Part:
        return self._part

    def send(self, data: str) -> None:
        self.done.append(data)

    def settle(self) -> None:
        self.done.append("the listener has handled it")

    def run_time(self, *_: float, **__: Any) -> bool:
        self.done.append("a pause")
        return True

    def wait_until(self, *_: Any) -> bool:
        return True


def test_between_the_texts_of_a_pair_the_listener_handles_the_first_and_no_time_passes() -> None:
    bench: Any = Bench(["one", "two", "three"], ["two"])
    Subscriber(pace=0.5, paced_by="a talker")._are_said_at_pace(bench, bench, ["one", "two", "three"])
    assert bench.done == ["one", "a pause", "two", "the listener has handled it", "three", "a pause"]


class Hung(Bench):
    """A bench with a listener that says the first text, and then no more. A copy of it comes later, on /rosout."""

    pace = Pace.REAL_TIME

    def __init__(self, texts: list[str]) -> None:
        super().__init__(texts, [])
        self.events = [Event(0.0, "interface", "", dict(REFERENCE.interface))]

    def seen(self) -> Part:
        return Part("listening", self._part.inputs, self.events)

    def send(self, data: str) -> None:
        self.events.append(Event(1.0, "sent", "/chatter", {"fields": {"data": data}}))
        if not self.done:
            self.events.append(Event(1.1, "output", "stdout", {"text": data}))
        self.done.append(data)

    def settle(self) -> None:
        if not self.seen().of("log"):
            self.events.append(Event(1.2, "log", "listener_node", {"text": self.done[0]}))

    def run_time(self, *_: float, **__: Any) -> bool:
        self.settle()
        return True

    def wait_until(self, condition: Any, *_: Any) -> bool:
        return bool(condition(Evidence([self.seen()], REFERENCE, real_time=True)))


def test_a_listener_that_says_nothing_in_a_whole_series_gets_no_other_one() -> None:
    texts = random_texts(Random(0))
    bench: Any = Hung(texts)
    assert not Subscriber(pace=0.5, paced_by="a talker")._all_are_said(bench, bench, texts)
    assert bench.done == texts[: 1 + AT_PACE]


@pytest.mark.parametrize("seed", range(20))
def test_each_series_has_pairs_and_the_seed_decides_which(seed: int) -> None:
    random = Random(seed)
    texts = random_texts(random)
    pairs = drawn_pairs(random, texts)
    rows = [texts[1 + AT_PACE * i : 1 + AT_PACE * (i + 1)] for i in range(TRIES)]
    assert all(sum(text in pairs for text in row[:-1]) >= PAIRS - 1 for row in rows)
    assert pairs != drawn_pairs(Random(seed + 1), texts)


def lost_in(row: list[str], pairs: list[str], work: float) -> list[str]:
    """The texts that a listener with a queue for one text loses if each keeps it busy for so many seconds."""
    now, free, waiting, lost = 0.0, 0.0, "", []
    for text in row:
        if waiting and free <= now:
            free, waiting = free + work, ""
        if free <= now:
            free = now + work
        else:
            lost += [waiting] * bool(waiting)
            waiting = text
        if text in pairs:
            now = free = max(now, free + work * bool(waiting))
            waiting = ""
        else:
            now += 0.5
    return lost


@pytest.mark.parametrize("seed", range(50))
def test_a_listener_that_is_too_slow_for_the_pace_loses_texts_in_each_series(seed: int) -> None:
    random = Random(seed)
    texts = random_texts(random)
    pairs = drawn_pairs(random, texts)
    rows = [texts[1 + AT_PACE * i : 1 + AT_PACE * (i + 1)] for i in range(TRIES)]
    for row in rows:
        assert [text for text in lost_in(row, pairs, work=1.0) if row.count(text) == 1]
    assert not any(lost_in(row, pairs, work=0.2) for row in rows)


@pytest.mark.parametrize(
    ("missing", "key"), [(["b"], "not_logged"), (["c"], "callback_too_slow"), (["b", "y"], "not_logged")]
)
def test_a_listener_that_misses_only_the_first_of_a_pair_or_a_kind_of_text_is_not_too_slow(
    missing: list[str], key: str
) -> None:
    at_pace, singly = list("abcdefgh"), [*"yz", *map(str, range(10))]
    texts = ["0", *at_pace, *(f"{row}{n}" for row in "pq" for n in range(AT_PACE)), *singly]
    events = [Event(0.0, "interface", "", dict(REFERENCE.interface))]
    for at, text in enumerate(["0", *at_pace, *singly]):
        events.append(Event(float(at), "sent", "/chatter", {"fields": {"data": text}}))
        events += [Event(at + 0.1, "output", "stdout", {"text": text})] * (text not in missing)
    evidence = Evidence([Part("listening", {"texts": texts, "pairs": ["b"]}, events)], REFERENCE)
    ladder = Subscriber(pace=0.5, paced_by="a talker").ladder
    assert next(m.key for m in ladder if m.recognize(evidence)) == key
