"""Diagnoses of a listener, from what it was sent and what it said."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.recipes.subscriber import Speaks

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
    ladder = [mistake for mistake in Speaks(pace=0.5, paced_by="a talker").ladder if mistake.key == key]
    found = next(filter(None, (mistake.recognise(evidence) for mistake in ladder)), None)
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
