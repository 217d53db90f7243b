"""A question: any spelling of the right choice passes, and the card lists the choices in the student's own order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.hunts.question import Question

if TYPE_CHECKING:
    from autograder.verdict import Verdict

CHOICES = ("the topic's name", "the type", "the QoS", "no spin", "the namespace")


def asked(*choices: str) -> Question:
    """A question whose right choice is the type."""
    return Question("lab.why", "Why?", "Say why.", right="the type", choices=choices or CHOICES)


def judged(*events: Event) -> Verdict:
    """The verdict on a run with these events."""
    part = Part("asked", {}, [Event(0.0, "noted", "choices", {"order": [*CHOICES]}), *events])
    return deciding.judge(asked().exercise(), Evidence([part], Reference("lab.why", {})), "s")


def returned(value: object) -> Event:
    """What the notebook tells of a function that has returned."""
    return Event(0.1, "subject", "returned", {"value": repr(value), "traceback": ""})


@pytest.mark.parametrize(
    "events",
    [
        (returned("the type"),),
        (returned(" The  Type. "),),
        (Event(0.1, "output", "stdout", {"text": "the type"}), Event(0.2, "subject", "exited", {"code": 0})),
    ],
    ids=["returned", "in another spelling", "printed by a program"],
)
def test_the_right_choice_passes(events: tuple[Event, ...]) -> None:
    assert judged(*events).passed


@pytest.mark.parametrize(
    ("value", "key", "words"),
    [
        ("the QoS", "wrong_choice", "“the QoS” is not the right choice."),
        ("types", "wrong_choice", "“types”, which is not one of the choices."),
        (None, "not_written", "There is no answer yet."),
    ],
)
def test_a_wrong_answer_does_not_tell_the_right_one(value: object, key: str, words: str) -> None:
    verdict = judged(returned(value))
    assert verdict.diagnosis is not None
    assert (verdict.diagnosis.key, verdict.score) == (key, 0)
    assert words in verdict.diagnosis.text
    listed = [choice for choice in CHOICES if f"“{choice}”" in verdict.diagnosis.next_step]
    assert len(listed) == (0 if value in CHOICES else len(CHOICES))


class OneStudent:
    """A bench that keeps the order of the choices."""

    def __init__(self) -> None:
        self.order: list[str] = []

    def note(self, _: str, order: list[str]) -> None:
        self.order = order

    def __getattr__(self, _: str) -> Any:
        return lambda *_: True


def order_for(student: str, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The order in which a student reads the choices."""
    monkeypatch.setenv("JUPYTERHUB_USER", student)
    bench: Any = OneStudent()
    asked().exercise().scenario(bench)
    return list(bench.order)


def test_each_student_has_an_order_that_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    orders = [order_for(student, monkeypatch) for student in ("ada", "bob", "cem", "dana", "ada")]
    assert orders[0] == orders[-1]
    assert len(set(map(tuple, orders))) > 1
    assert all(sorted(order) == sorted(CHOICES) for order in orders)


@pytest.mark.parametrize("choices", [("the type",), ("the QoS", "The  qos")])
def test_a_question_without_a_choice_is_refused(choices: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match=r"lab\.why: write a wrong choice"):
        asked(*choices).exercise()
