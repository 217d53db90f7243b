"""Who has waited long enough to have missed a server by a moment: no ROS is started."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.lateness import (
    PATIENT,
    PATIENT_WITH_AN_ANSWER,
    was_patient,
    was_patient_with_an_answer,
)

SEEN = Event(0.4, "interface", "graph", {"nodes": ["/client"]})


def ended(t: float) -> Event:
    return Event(t, "subject", "exited", {"code": 1})


def said(t: float) -> Event:
    return Event(t, "output", "stderr", {"text": "there is no action server"})


@pytest.mark.parametrize(
    ("events", "expected"),
    [
        ([SEEN, said(0.4 + PATIENT), ended(0.5 + PATIENT)], True),
        ([SEEN, said(0.9), ended(0.4 + 2 * PATIENT)], False),
        ([SEEN, ended(0.4 + PATIENT)], True),
        ([SEEN, ended(0.9)], False),
        ([SEEN, Event(0.5, "spared", "a wait for a server", {"seconds": PATIENT}), ended(0.6)], True),
        ([SEEN, Event(0.5, "spared", "a wait for a server", {"seconds": 0.01}), ended(0.6)], False),
        ([ended(9.0)], False),
        ([SEEN], False),
    ],
)
def test_patience_is_counted_from_the_first_sign_of_life_to_the_last_word(
    events: list[Event], expected: bool
) -> None:
    assert was_patient(Part("", {}, events)) is expected


GOAL = Event(1.0, "goal", "/fibonacci", {"fields": {"order": 5}})
CANCEL = Event(3.0, "cancel", "/fibonacci", {"accepted": True})


@pytest.mark.parametrize(
    ("events", "expected"),
    [
        ([GOAL, said(1.1 + PATIENT_WITH_AN_ANSWER), ended(2.2)], True),
        ([GOAL, said(1.1), ended(1.0 + 2 * PATIENT_WITH_AN_ANSWER)], False),
        ([GOAL, CANCEL, said(3.1 + PATIENT_WITH_AN_ANSWER), ended(4.2)], True),
        ([GOAL, CANCEL, said(3.1), ended(3.2)], False),
        ([GOAL, said(1.1 + PATIENT_WITH_AN_ANSWER)], False),
        ([SEEN, said(2.0), ended(3.0)], False),
    ],
)
def test_patience_with_an_answer_is_counted_from_the_last_request(
    events: list[Event], expected: bool
) -> None:
    assert was_patient_with_an_answer(Part("", {}, events), ["goal", "cancel"]) is expected
