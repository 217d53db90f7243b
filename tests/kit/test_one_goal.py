"""In which order the judge's action server answers, sends feedback and ends a goal."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any, cast
from unittest.mock import MagicMock

import pytest

from autograder.kit.bench import Bench, Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.goal_reports import ABORTED, LATE, REFUSED
from autograder.kit.recipes import one_goal
from autograder.kit.recipes.one_goal import (
    AFTERMATH,
    AT_PACE,
    aborted,
    refuse,
    refused,
    unserved,
    works_on_a_goal,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.counterparts import ActionCounterpart


class PatientClient:
    """A bench and its action server in one: the client asks for the result when it is waited for, and then ends."""

    pace = Pace.FAST
    in_a_cell = False
    shows = False
    reference = Reference("lab_9_1.client", {"action_client": {"/fibonacci": "a_package/action/Fibonacci"}})

    def __init__(self) -> None:
        self.random = random.Random(0)
        self.events: list[Event] = []

    def happens(self, kind: str, **data: Any) -> bool:
        self.events.append(Event(float(len(self.events)), kind, "/fibonacci", data))
        return True

    def wait_until(
        self, condition: Callable[[Evidence], bool], within: float, *, quiet: float | None = None
    ) -> bool:
        return condition(Evidence([self.seen()], Reference("lab_9_1.client", {})))

    def seen(self) -> Part:
        return Part("a run", {"order": 41}, self.events)

    def send_feedback(self, **fields: Any) -> None:
        self.happens("feedback", fields=fields)
        if self.shows:
            self.happens("log", text=str(fields))

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

    def run_time(self, seconds: float, until: Callable[[], bool]) -> bool:
        return until()

    def pass_time(self, seconds: float, role: str, name: str) -> None:
        self.happens("time")


def test_feedback_begins_when_the_client_has_asked_for_the_result() -> None:
    client = PatientClient()
    assert works_on_a_goal(cast("Bench", client), cast("ActionCounterpart", client), "succeeded", 2, 0.5)
    kinds = [event.kind for event in client.events if event.kind != "time"]
    assert kinds == ["goal_answered", "result_request", "feedback", "feedback", "result"]


@pytest.mark.parametrize("shows", [True, False], ids=["shows each message", "shows the newest from a timer"])
def test_the_last_feedback_comes_at_a_pace_unless_the_client_has_shown_all_of_it(shows: bool) -> None:
    client = PatientClient()
    client.shows = shows
    assert works_on_a_goal(cast("Bench", client), cast("ActionCounterpart", client), "succeeded", 5, 0.5)
    kinds = [event.kind for event in client.events if event.kind in ("feedback", "time")]
    paced = ["feedback"] if shows else ["feedback", "time"]
    assert kinds == ["feedback"] * (5 - AT_PACE) + paced * (AT_PACE - 1) + ["feedback"]


def test_a_result_has_one_number_more_than_its_order_says() -> None:
    client = PatientClient()
    assert works_on_a_goal(cast("Bench", client), cast("ActionCounterpart", client), "succeeded", 1, 0.5)
    (result,) = (event for event in client.events if event.kind == "result")
    assert len(result.data["fields"]["sequence"]) == 42


GOAL = Event(1.0, "goal", "/fibonacci", {"fields": {"order": 41}})
ANSWERED = Event(1.1, "goal_answered", "/fibonacci")
ENDED = Event(9.0, "subject", "exited", {"code": 0})
ORDERED = {"order": 41}


def _said(text: str) -> Event:
    return Event(6.0, "output", "stdout", {"text": text})


def _looked(name: str, *events: Event) -> Part:
    return Part(name, ORDERED, [GOAL, ANSWERED, Event(5.0, "result", "/fibonacci"), *events])


FIRST = _looked(LATE, _said("succeeded"), ENDED)


@pytest.mark.parametrize(
    ("run", "name", "word"), [(aborted, ABORTED, "aborted"), (refused, REFUSED, "rejected")]
)
@pytest.mark.parametrize(
    ("says", "kept", "made"), [("right", True, False), ("right", False, True), ("wrong", True, True)]
)
def test_the_second_look_does_not_repeat_a_run_in_which_nothing_was_wrong(
    run: Callable[[Bench, Part], None],
    name: str,
    word: str,
    says: str,
    kept: bool,
    made: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(one_goal, "meets_present", lambda *_, **__: True)
    line = _said(word if says == "right" else "it is over")
    before = Evidence([FIRST, _looked(name, line, ENDED)], PatientClient.reference)
    bench = MagicMock(pace=Pace.REAL_TIME, before=before, random=random.Random(0), keep=lambda _: kept)
    run(bench, FIRST)
    assert bench.part.called == made


@pytest.mark.parametrize(("may_stay", "waits"), [(True, [AFTERMATH, 0.0]), (False, [0.0])])
def test_a_client_that_may_stay_is_not_waited_for_once_it_has_said_rejected(
    may_stay: bool, waits: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    waited: list[float] = []
    monkeypatch.setattr(one_goal, "meets_present", lambda _, meet, *__, **___: meet())
    seen = Evidence([Part(REFUSED, ORDERED, [GOAL, _said("rejected")])], PatientClient.reference)
    bench = MagicMock(pace=Pace.FAST)
    bench.reference.only.return_value = ("/fibonacci", "a_package/action/Fibonacci")
    bench.wait_until = lambda condition, _: condition(seen)
    bench.await_end = lambda within: waited.append(within)
    refuse(bench, lambda: None, known=True, may_stay=may_stay)
    assert waited == waits


@pytest.mark.parametrize("kept", [True, False])
def test_a_program_that_ended_without_a_server_is_not_run_without_one_again(kept: bool) -> None:
    bench = MagicMock(pace=Pace.REAL_TIME, before=None, random=random.Random(0), keep=lambda _: kept)
    bench.reference.only.return_value = ("/fibonacci", "a_package/action/Fibonacci")
    unserved(bench, FIRST)
    assert bench.part.called == (not kept)
