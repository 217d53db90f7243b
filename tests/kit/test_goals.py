"""Goals of any action type, as the judge has seen them."""

from __future__ import annotations

from typing import Any

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.mistakes.action_server_mistakes import RESULT_MISSING
from autograder.kit.outcomes import SUCCEEDED, all_goals, goal

ACTION, TYPE = "/drive", "a_package/action/DriveTo"


def seen(kind: str, **data: Any) -> Event:
    return Event(0.0, kind, ACTION, {"goal": 0, **data})


PART = Part(
    "main",
    {},
    [
        seen("goal_sent", fields={"x": 1.6, "y": 2.0}),
        seen("goal_answer", accepted=True),
        seen("feedback_heard", fields={"distance": 1.2}, sent=1.0),
        seen("cancel_sent"),
        seen("feedback_heard", fields={"distance": 0.4}, sent=2.0),
        seen("cancel_answer", accepted=False),
        seen("result_heard", status=SUCCEEDED, fields={"arrived": True, "steps": 3}),
    ],
)


def test_a_goal_has_the_fields_of_its_own_type() -> None:
    one = goal(PART, 0)
    assert (one.request, one.feedback) == ({"x": 1.6, "y": 2.0}, [{"distance": 1.2}, {"distance": 0.4}])
    assert (one.before_cancel, one.unread, one.result) == (1, 1, {"arrived": True, "steps": 3})
    assert all_goals(PART) == [one]


def test_a_goal_that_was_never_sent_has_no_fields() -> None:
    never = goal(PART, 1)
    assert (never.request, never.feedback, never.result, never.over) == (None, [], {}, False)


@pytest.mark.parametrize(("field", "found"), [("_steps", True), ("arrived", True), ("sequence", False)])
def test_a_missing_result_is_told_in_the_words_of_the_action(field: str, found: bool) -> None:
    traceback = f"AttributeError: 'NoneType' object has no attribute '{field}'"
    part = Part("main", {}, [Event(0.0, "subject", "raised", {"traceback": traceback})])
    advice = RESULT_MISSING.recognize(
        Evidence([part], Reference("", {"action_server": {ACTION: TYPE}}, [PART]))
    )
    assert (advice is not None) is found
    assert advice is None or "DriveTo.Result() in which you have set arrived and steps" in advice.next_step


def test_a_result_without_an_answer_to_its_goal_is_a_goal_that_was_not_answered() -> None:
    alone = goal(Part("main", {}, [seen("result_heard", status=SUCCEEDED, fields={})]), 0)
    assert (alone.accepted, alone.seconds, alone.status) == (None, None, SUCCEEDED)
