"""A trial of an exercise says which step was slow, and with --fast looks only once at what is expected to be wrong."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from autograder import exercises
from autograder.authoring import exercise_trial
from autograder.authoring.answer_bank import Answer
from autograder.authoring.exercise_trial import slowest_step
from autograder.judge import command_check
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.verdict import not_checked

if TYPE_CHECKING:
    from autograder.kit.model import Exercise

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


@pytest.mark.parametrize("fast", [False, True])
def test_fast_leaves_out_second_looks_at_wrong_answers_alone(
    monkeypatch: pytest.MonkeyPatch, fast: bool
) -> None:
    looks: dict[str, bool] = {}
    names = {"right": (), "wrong": ("topic_name",)}
    bank = [Answer("lab_1_2.talker", Path(f"{kind}/a.py"), ("true",), keys) for kind, keys in names.items()]

    def checked_here(exercise: Exercise, command: Any, seed: str, cwd: None) -> tuple[Any, None]:
        looks[command[0]] = exercise.second_look
        return not_checked(exercise.id, "", 10, "a test"), None

    def judged(wanted: list[Answer], **_: Any) -> list[Any]:
        for answer in wanted:
            looks[answer.file.parent.name] = answer.looks_twice
            answer.verdict("s")
        return []

    monkeypatch.setattr(command_check, "checked_here", checked_here)
    monkeypatch.setattr(exercise_trial, "_chosen", lambda *_: bank)
    monkeypatch.setattr(exercise_trial, "_refuse_edits_that_do_not_fit", lambda _: None)
    monkeypatch.setattr(exercise_trial, "_judged", judged)
    exercise_trial.try_exercise(exercises.get("lab_1_2.talker"), only=["a"], fast=fast, tell=lambda _: None)
    assert looks == {"right": True, "wrong": not fast, "true": not fast}
