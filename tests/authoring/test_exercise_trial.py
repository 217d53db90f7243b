"""A trial of an exercise says which step was slow."""

from __future__ import annotations

import pytest

from autograder.authoring.tried_answers import slowest_step
from autograder.kit.evidence import Event, Evidence, Part, Reference

REFERENCE = Reference("lab.relay", {})
SLOW = Evidence([Part("met", {}, [Event(0.5, "sent", "/a"), Event(4.5, "message", "/b")])], REFERENCE)
FAST = Evidence([Part("met", {}, [Event(0.5, "sent", "/a"), Event(1.5, "message", "/b")])], REFERENCE)


@pytest.mark.parametrize(
    ("look", "seconds", "words"),
    [
        (SLOW, 6.0, "4.0 s in “met”, between sent /a and message /b"),
        (FAST, 2.0, ""),
        (FAST, 9.0, ""),
        (
            Evidence(
                [Part("met", {}, [Event(0.0, "sent", "/a"), Event(6.0, "sent", "/a")])], REFERENCE, True, FAST
            ),
            8.0,
            "6.0 s in “met”, in real time, between sent /a and sent /a",
        ),
    ],
    ids=["between events", "in short steps", "without events", "in the second look"],
)
def test_the_slowest_step_is_named(look: Evidence, seconds: float, words: str) -> None:
    assert slowest_step(look, seconds) == words
