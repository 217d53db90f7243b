"""Goals that the judge sends: as steps of the oracle, and what a view of them shows about a server."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.oracle.action_server import SendsGoals
from autograder.kit.oracle.goal_sender import GoalSender
from autograder.kit.oracle.goals_seen import ComparedGoal, GoalsSeen
from autograder.kit.oracle.same_as_solution import Goal, SameAsSolution
from autograder.kit.outcomes import ABORTED, CANCELED, SUCCEEDED, SentGoal, goal

ACTION, TYPE = "/dock", "a_package/action/Dock"


def events_of(number: int, *, status: int = SUCCEEDED, accepted: bool = True) -> list[Event]:
    """Return what the judge saw of a goal with five feedback messages."""

    def event(kind: str, **data: Any) -> Event:
        return Event(9.0 * (kind == "result_heard"), kind, ACTION, {"goal": number, **data})

    answered = [event("goal_sent", fields={"distance": 3}), event("goal_answer", accepted=accepted)]
    feedback = [event("feedback_heard", fields={"left": left}, sent=9.0 - left) for left in range(5, 0, -1)]
    ended = event("result_heard", status=status, fields={"place": {"arrived": True}})
    return [*answered, *feedback, ended] if accepted else answered


def part(**how: Any) -> Part:
    return Part("main", {}, events_of(0, **how))


def sent(**how: Any) -> SentGoal:
    return goal(part(**how), 0)


PATHS = ("status", "feedback.left", "result.place.arrived")


@pytest.mark.parametrize(
    ("step", "seen", "came"),
    [
        (Goal(ACTION, {}), part(), ["SUCCEEDED", [5, 4, 3, 2, 1], True]),
        (Goal(ACTION, {}), part(status=ABORTED), ["ABORTED", [5, 4, 3, 2, 1], True]),
        (Goal(ACTION, {}), part(accepted=False), ["REJECTED", [], None]),
        (Goal(ACTION, {}, cancel_after=2), part(status=CANCELED), ["CANCELED", [5, 4], True]),
    ],
)
def test_what_comes_of_a_goal_is_its_status_its_feedback_and_its_result(
    step: Goal, seen: Part, came: list[Any]
) -> None:
    assert step.outcomes(seen, PATHS) == [came]


def test_a_subject_that_works_on_after_a_cancel_has_another_status() -> None:
    events = events_of(0, status=CANCELED)
    place = next(n for n, event in enumerate(events) if event.kind == "feedback_heard")
    cancel = [
        Event(3.0, "cancel_sent", ACTION, {"goal": 0}),
        Event(3.1, "cancel_answer", ACTION, {"goal": 0, "accepted": True, "arrived": 3.1}),
    ]
    step, paths = Goal(ACTION, {}, cancel_after=1), ("status", "result.place.arrived", "result.place.x")
    events[-1] = replace(
        events[-1], data={**events[-1].data, "fields": {"place": {"arrived": False, "x": 3.5}}}
    )
    soon = Part("main", {}, [*events[: place + 5], *cancel, *events[place + 5 :]])
    assert step.outcomes(soon, paths) == [["CANCELED, long after the request", False, None]]
    late = [replace(event, data={**event.data, "arrived": 8.5}) for event in cancel]
    assert step.outcomes(replace(soon, events=[*events, *late]), paths) == [["CANCELED", False, None]]


class Noting:
    """Takes the place of a sender, and notes what a step asks it to do."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, Any]] = []

    def send(self, **fields: Any) -> int:
        self.asked.append(("send", fields["distance"]))
        return len([word for word, _ in self.asked if word == "send"]) - 1

    def pass_time(self, number: int, messages: int) -> None:
        self.asked.append(("pass_time", (number, messages)))

    def finish(self, *numbers: int) -> bool:
        self.asked.append(("finish", numbers))
        return True


def test_a_goal_beside_another_one_is_sent_at_once_or_while_it_is_at_work() -> None:
    later = Goal(ACTION, {"distance": 1}, after=7)
    step = Goal(ACTION, {"distance": 9}, beside=Goal(ACTION, {"distance": 2}, beside=later))
    sender = Noting()
    assert step.play(cast("GoalSender", sender))
    assert sender.asked == [
        ("send", 9),
        ("send", 2),
        ("pass_time", (0, 7)),
        ("send", 1),
        ("finish", (0, 1, 2)),
    ]
    assert str(step).endswith("beside /dock with distance 1 after 7 feedback messages")


def test_a_card_says_which_goal_differs() -> None:
    def run(status: str) -> Part:
        data = {"step": 1, "given": str(step), "values": [[status, [5, 4]]]}
        return Part("drawing 0", {}, [Event(1.0, "noted", ACTION, data)])

    step = Goal(ACTION, {"distance": 9}, cancel_after=2, beside=Goal(ACTION, {"distance": 1}))
    exercise = SameAsSolution(
        "a.b",
        "A",
        "B",
        gives=lambda _: [step],
        tells={ACTION: ("status", "feedback.left")},
        roles=("action_server",),
    ).exercise()
    reference = Reference("a.b", {"action_server": {ACTION: TYPE}}, [run("CANCELED")])
    (criterion,) = exercise.criteria
    assert criterion.judge(Evidence([run("CANCELED")], reference)).passed
    finding = criterion.judge(Evidence([run("SUCCEEDED")], reference))
    words = "/dock with distance 9, canceled after 2 feedback messages, beside /dock with distance 1"
    assert not finding.passed
    assert finding.seen == f"status = SUCCEEDED, feedback.left = [5, 4] after {words}"
    assert "result_missing" in [one.key for one in exercise.mistakes]


def compared(seen: SentGoal, fault: str = "", slip: str = "") -> ComparedGoal:
    return ComparedGoal(**vars(seen), due=None, fault=fault, slip=slip, feedback_fault=slip)


def view(*later: ComparedGoal, canceled: SentGoal, evidence: Evidence) -> GoalsSeen:
    alone, long = [compared(sent())], compared(canceled)
    return GoalsSeen(evidence, alone, later[:1], later, [*alone, *later, long], [], [], [long], None)


def told(*later: ComparedGoal, canceled: SentGoal, parts: list[Part] | None = None) -> str:
    """Return the key of the first mistake that the recipe names."""
    recorded = [Part("main", {}, events_of(0))]
    evidence = Evidence(parts or recorded, Reference("", {"action_server": {ACTION: TYPE}}, recorded))
    recipe = SendsGoals(lambda _: None, lambda seen: view(*later, canceled=canceled, evidence=seen))
    return next((one.key for one in recipe.ladder if one.recognize(evidence)), "")


HONORED = replace(sent(status=CANCELED), cancel_accepted=True, unread=0)


@pytest.mark.parametrize(
    ("later", "canceled", "key"),
    [
        ([compared(sent(accepted=False))], HONORED, "goal_rejected"),
        ([compared(sent(), "a fault")], HONORED, "goals_mixed_up"),
        ([compared(sent(), slip="a slip")], HONORED, "goals_mixed_up"),
        ([compared(sent())], replace(sent(), cancel_accepted=None, unread=6), "cancel_not_accepted"),
    ],
)
def test_common_mistakes_follow_from_what_came_of_the_goals(
    later: list[ComparedGoal], canceled: SentGoal, key: str
) -> None:
    assert told(*later, canceled=canceled) == key


class Bench:
    """A bench without ROS, on which each wait brings the next event of a server."""

    def __init__(self, *events: Event) -> None:
        self.pace, self.waiting = "fast", list(events)
        self.heard: list[Event] = []
        self.canceled: list[tuple[int, int]] = []

    def seen(self) -> Part:
        return Part("main", {}, self.heard)

    def wait_until(self, condition: Any, _: float, **__: Any) -> bool:
        while not condition(Evidence([self.seen()], Reference("", {}))):
            if not self.waiting:
                return False
            self.heard.append(self.waiting.pop(0))
        return True

    def settle(self) -> None:
        """Nothing more comes."""

    def await_end(self, _: float) -> bool:
        return False

    def cancel(self, number: int) -> None:
        self.canceled.append((number, len(goal(self.seen(), number).feedback)))


@pytest.mark.parametrize(("after", "canceled"), [(3, [(0, 3)]), (9, [])])
def test_a_goal_is_canceled_after_so_many_messages_unless_it_is_over(
    monkeypatch: pytest.MonkeyPatch, after: int, canceled: list[tuple[int, int]]
) -> None:
    for limits in ("QUIET", "CANCEL_LIMIT", "GOAL_LIMIT"):
        monkeypatch.setattr(f"autograder.kit.oracle.goal_sender.{limits}", {"fast": 1.0})
    bench: Any = Bench(*events_of(0))
    sender = GoalSender(bench, bench)
    sender.cancel(0, after=after)
    assert bench.canceled == canceled
    assert sender.finish(0)
    assert not sender.finish(0, 1)


@pytest.mark.parametrize(("most", "noted"), [(1, [33]), (40, []), (None, [31])])
def test_a_goal_for_which_feedback_comes_without_end_is_not_awaited(
    monkeypatch: pytest.MonkeyPatch, most: int | None, noted: list[int]
) -> None:
    for limits in ("QUIET", "GOAL_LIMIT"):
        monkeypatch.setattr(f"autograder.kit.oracle.goal_sender.{limits}", {"fast": 1.0})
    *begin, feedback = [event for event in events_of(0) if event.kind != "result_heard"][:3]
    bench: Any = Bench(*begin, *[feedback] * 60)
    told: list[int] = []
    bench.note = lambda _, feedback: told.append(feedback)
    sender = GoalSender(bench, bench, most=most)
    assert not sender.finish(0)
    assert told[:1] == noted
    assert bool(bench.waiting) is bool(noted)
