"""What is made of a client whose goal is refused, by both exercises about clients of actions: no ROS is started."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.goal_reports import REFUSED, refused_as_seen
from autograder.kit.mistakes.crashes import traceback_of
from autograder.kit.mistakes.goal_mistakes import REFUSAL_NOT_REPORTED, crashed_by_refusal

REFERENCE = Reference("exercise_1_3.cancel", {})
FRAME = '  File "/home/student/client.py", line 9, in run_client\n    '
SLIP = f"Traceback (most recent call last):\n{FRAME}print(NAMES[answer.status])\nKeyError: 0"
MEANT = f"Traceback (most recent call last):\n{FRAME}raise RuntimeError('rejected')\nRuntimeError: rejected"
GOAL = Event(0.0, "goal", "/fibonacci", {"fields": {"order": 20}})
ASKED = Event(0.2, "result_request", "/fibonacci", {"known": True})
RESULT = Event(0.3, "result", "/fibonacci", {"status": "canceled", "fields": {"sequence": []}})


def say(text: str) -> Event:
    return Event(0.4, "output", "stdout", {"text": text})


def raised(traceback: str) -> Event:
    return Event(0.5, "subject", "raised", {"traceback": traceback})


def evidence(
    refused: list[Event], *, canceled: str = "ended as CANCELED", end: Event | None = None
) -> Evidence:
    answered = Event(0.1, "goal_answered", "/fibonacci")
    last = end or Event(0.5, "subject", "returned")
    head = [GOAL, answered, ASKED, RESULT]
    return Evidence(
        [
            Part("the server cancels", {}, [*head, say(canceled), last]),
            Part("the server refuses to cancel", {}, [*head, say("ended with 4"), last]),
            Part(REFUSED, {}, [GOAL, *refused]),
        ],
        REFERENCE,
    )


@pytest.mark.parametrize(
    ("refused", "wrong"),
    [
        ([raised(MEANT)], ""),
        ([say("rejected"), Event(0.5, "subject", "returned")], ""),
        ([ASKED, say("ended with 0"), Event(0.5, "subject", "returned")], "“ended with 0”"),
        ([ASKED, raised(SLIP)], "it was not reported"),
        ([Event(0.5, "subject", "returned")], "it was not reported"),
        ([], "it was not reported"),
        ([say("rejected")], "the rejection was reported, but the client did not end"),
    ],
)
def test_a_refusal_is_told_in_words_of_no_other_run(refused: list[Event], wrong: str) -> None:
    seen = refused_as_seen(evidence(refused))
    assert seen.startswith(wrong) if wrong else seen == ""


def test_a_run_that_never_was_is_not_called_a_run_without_a_goal() -> None:
    assert refused_as_seen(Evidence(evidence([]).parts[:2], REFERENCE)) == "not reached"


def test_an_exception_that_only_a_refusal_causes_is_not_taken_for_a_mistake_of_its_own() -> None:
    assert crashed_by_refusal(evidence([ASKED, raised(SLIP)]))
    assert not crashed_by_refusal(evidence([raised(MEANT)]))
    assert not crashed_by_refusal(evidence([raised(SLIP)], end=raised(SLIP)))


def test_who_says_nothing_is_told_the_word() -> None:
    advice = REFUSAL_NOT_REPORTED.recognize(evidence([Event(0.5, "subject", "returned")]))
    assert advice is not None
    assert "`rejected`" in advice.text


def test_what_is_raised_on_purpose_at_a_refusal_does_not_hide_a_slip_in_another_run() -> None:
    assert traceback_of(evidence([raised(MEANT)], end=raised(SLIP))) == SLIP
    assert traceback_of(evidence([raised(MEANT)])) == MEANT
