"""In which order the judge's action server answers, sends feedback and ends a goal."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any, cast

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.model import Bench, Pace
from autograder.kit.recipes.action_client import AT_PACE, works_on_a_goal

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.counterparts import ActionCounterpart


class PatientClient:
    """A bench and its action server in one: the client asks for the result when it is waited for, and then ends."""

    pace = Pace.FAST
    in_a_cell = False
    reference = Reference("lab_9_1.client", {"action_client": {"/fibonacci": "a_package/action/Fibonacci"}})

    def __init__(self) -> None:
        self.random = random.Random(0)
        self.events: list[Event] = []

    def happens(self, kind: str, **data: Any) -> bool:
        self.events.append(Event(float(len(self.events)), kind, "/fibonacci", data))
        return True

    def wait_until(self, condition: Callable[[Evidence], bool], within: float) -> bool:
        return condition(Evidence([self.seen()], Reference("lab_9_1.client", {})))

    def seen(self) -> Part:
        return Part("a run", {"order": 41}, self.events)

    def send_feedback(self, **fields: Any) -> None:
        self.happens("feedback", fields=fields)

    def finish(self, status: str, **fields: Any) -> None:
        self.happens("result", status=status, fields=fields)

    def await_goal(self, within: float) -> bool:
        return self.happens("goal_answered")

    def await_result_request(self, within: float) -> bool:
        return bool(self.seen().of("result_request")) or self.happens("result_request")

    def await_end(self, within: float) -> bool:
        return True

    def settle(self) -> None:
        pass

    def run_time(self, seconds: float) -> bool:
        return True

    def pass_time(self, seconds: float, role: str, name: str) -> None:
        self.happens("time")


def test_feedback_begins_when_the_client_has_asked_for_the_result() -> None:
    client = PatientClient()
    assert works_on_a_goal(cast("Bench", client), cast("ActionCounterpart", client), "succeeded", 2, 0.5)
    kinds = [event.kind for event in client.events if event.kind != "time"]
    assert kinds == ["goal_answered", "result_request", "feedback", "feedback", "result"]


def test_the_last_feedback_comes_at_a_pace_whether_it_was_shown_or_not() -> None:
    client = PatientClient()
    assert works_on_a_goal(cast("Bench", client), cast("ActionCounterpart", client), "succeeded", 5, 0.5)
    kinds = [event.kind for event in client.events if event.kind in ("feedback", "time")]
    assert kinds == ["feedback"] * (5 - AT_PACE) + ["feedback", "time"] * (AT_PACE - 1) + ["feedback"]


def test_a_result_has_one_number_more_than_its_order_says() -> None:
    client = PatientClient()
    assert works_on_a_goal(cast("Bench", client), cast("ActionCounterpart", client), "succeeded", 1, 0.5)
    (result,) = (event for event in client.events if event.kind == "result")
    assert len(result.data["fields"]["sequence"]) == 42
