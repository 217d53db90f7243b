"""Declared exercises judge by what is due after the inputs that were given."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.recipes.machine import SOME_TEXT, Machine
from autograder.kit.recipes.relay import NAN, NUMBER, SILENCE, WHOLE, Hub, Relay, Reply, To, _drawn
from autograder.kit.rules import same

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.model import Exercise

INTERFACE = {
    "publisher": {"/out": "x/msg/Y"},
    "subscription": {"/in": "x/msg/Y"},
    "service": {"/s": "x/srv/Y"},
}


def event(kind: str, fields: dict[str, Any], **more: Any) -> Event:
    """One event on the wire."""
    return Event(0.0, kind, "/any", {"fields": fields, **more})


def passed(exercise: Exercise, seen: Sequence[Event], usual: Sequence[Event]) -> dict[str, bool]:
    """Judge a run against the recorded one."""
    evidence = Evidence([Part("run", {}, seen)], Reference(exercise.id, INTERFACE, [Part("run", {}, usual)]))
    return {criterion.name: criterion.judge(evidence).passed for criterion in exercise.criteria}


def diagnoses(exercise: Exercise, seen: Sequence[Event]) -> set[str]:
    """Return the exercise's own mistakes that are recognized."""
    evidence = Evidence([Part("run", {}, seen)], Reference(exercise.id, INTERFACE))
    own = {"summed", "not_copied", "too_early", "stays_so", "told_too_often", "not_latched"}
    return {one.key for one in exercise.mistakes if one.key in own and one.recognize(evidence)}


def differences() -> Exercise:
    """The difference of two numbers, from the second on; nested fields."""

    def due(numbers: Sequence[float]) -> Any:
        return numbers[-1] - numbers[-2] if len(numbers) > 1 else SILENCE

    relay = Relay(
        "a.b", "A", "B", field="pose.x", gives=lambda _: [1.0, 3.0, NAN], due=due, copies="header.stamp"
    )
    relay.answers("due", 5, "Answers")
    relay.copies("stamp", 5, "Copies")
    relay.wrong("summed", lambda n: n[-1] + n[-2] if len(n) > 1 else SILENCE, "It adds.", "Take away.")
    relay.not_copied()
    relay.too_early()
    return relay.exercise()


def heard(kind: str, x: float, sec: int) -> Event:
    """A message with nested fields."""
    return event(kind, {"pose": {"x": x}, "header": {"stamp": {"sec": sec}}})


SENT = [heard("sent", 1.0, 1), heard("sent", 3.0, 2), heard("sent", NAN, 3)]
RIGHT = [SENT[0], SENT[1], heard("message", 2.0, 2), SENT[2], heard("message", NAN, 3)]


@pytest.mark.parametrize(
    ("seen", "expected", "told"),
    [
        (RIGHT, {"due": True, "stamp": True}, set()),
        (RIGHT[:3], {"due": False, "stamp": False}, set()),
        ([], {"due": False, "stamp": False}, set()),
        (
            [*SENT[:2], heard("message", 4.0, 2), SENT[2], heard("message", NAN, 3)],
            {"due": False, "stamp": True},
            {"summed"},
        ),
        (
            [*SENT, heard("message", 2.0, 0), heard("message", NAN, 0)],
            {"due": True, "stamp": False},
            {"not_copied"},
        ),
        (
            [SENT[0], heard("message", 1.0, 1), *RIGHT[1:]],
            {"due": False, "stamp": True},
            {"too_early"},
        ),
    ],
)
def test_a_relay_is_judged_by_what_is_due(
    seen: Sequence[Event], expected: dict[str, bool], told: set[str]
) -> None:
    assert passed(differences(), seen, RIGHT) == expected
    assert diagnoses(differences(), seen) == told


def test_a_wrong_relay_may_be_the_right_one_with_another_argument() -> None:
    def due(numbers: Sequence[float], lag: int = 1) -> Any:
        return numbers[-1] - numbers[-1 - lag] if len(numbers) > lag else SILENCE

    relay = Relay("a.b", "A", "B", field="pose.x", due=due)
    relay.wrong("summed", {"lag": 0}, "It is always 0.", "Keep the number before.")
    zeros = [event for sent in SENT[:2] for event in (sent, heard("message", 0.0, 1))]
    assert diagnoses(relay.exercise(), zeros) == {"summed"}
    assert diagnoses(relay.exercise(), RIGHT) == set()


def test_a_relay_that_ended_early_is_not_told_of_a_mistake_that_would_have_shown_later() -> None:
    def due(numbers: Sequence[float], most: float = 9.0) -> Any:
        return min(numbers[-1], most)

    relay = Relay("a.b", "A", "B", field="pose.x", due=due)
    relay.wrong("summed", {"most": 1.0}, "It is never more than 1.", "Leave the limit out.")
    first = [SENT[0], heard("message", 1.0, 1), SENT[1]]
    assert diagnoses(relay.exercise(), first) == set()
    assert diagnoses(relay.exercise(), [*first, heard("message", 1.0, 2)]) == {"summed"}


def scales() -> Exercise:
    """The sum of two topics, less what a service has set to nothing; the service refuses before there is a sum."""

    def due(given: Sequence[To], start: float | None = None, *, always: bool = False) -> Any:
        newest, tared, out = {"/a": start, "/b": start}, 0.0, SILENCE
        for name, number in given:
            newest |= {name: number} if name in newest else {}
            there = [one for one in newest.values() if one is not None]
            if name == "/tare":
                tared = sum(there) if len(there) == 2 else tared
                out = Reply({"success": always or len(there) == 2})
            else:
                out = sum(there) - tared if len(there) == 2 else SILENCE
        return out

    hub = Hub(
        "a.b",
        "A",
        "B",
        field="data",
        due=due,
        gives=[To("/a", 1)],
        roles=("subscription", "publisher", "service"),
    )
    hub.answers("totals", 5, "Totals")
    hub.replies("success", 5, "Success")
    hub.wrong("summed", {"start": 0.0}, "It adds too early.", "Wait.")
    hub.wrong("stays_so", {"always": True}, "It always says success.", "Refuse.")
    return hub.exercise()


def weighed(totals: Sequence[float], replies: Sequence[bool], *, early: bool = False) -> list[Event]:
    """The run of a node on two scales that published these totals, and replied so to calls at the first and the end."""
    a, b, c = (
        Event(0.0, "sent", name, {"fields": {"data": n}})
        for name, n in (("/a", 1.0), ("/b", 2.0), ("/a", 5.0))
    )
    call = Event(0.0, "asked", "/tare", {"fields": {}})
    said = [event("message", {"data": total}) for total in totals]
    told = [event("answered", {"success": one, "message": ""}) for one in replies]
    return [call, *told[:1], a, *said[:early], b, *said[early:][:1], call, *told[1:], c, *said[early:][1:]]


@pytest.mark.parametrize(
    ("seen", "failed", "told"),
    [
        (weighed([3.0, 4.0], [False, True]), set(), set()),
        (weighed([1.0, 3.0, 4.0], [False, True], early=True), {"totals"}, set()),
        (weighed([1.0, 3.0, 4.0], [True, True], early=True), {"totals", "success"}, {"summed"}),
        (weighed([3.0, 4.0], [True, True]), {"success"}, {"stays_so"}),
        (weighed([3.0, 7.0], [False, True]), {"totals"}, set()),
        (weighed([3.0], [False]), {"totals", "success"}, set()),
        ([], {"totals", "success"}, set()),
    ],
    ids=[
        "right",
        "early",
        "early with success",
        "always success",
        "other sum",
        "hangs in the call",
        "nothing",
    ],
)
def test_a_hub_is_judged_by_its_messages_and_replies(
    seen: Sequence[Event], failed: set[str], told: set[str]
) -> None:
    verdict = passed(scales(), seen, weighed([3.0, 4.0], [False, True]))
    assert {name for name, holds in verdict.items() if not holds} == failed
    assert diagnoses(scales(), seen) == told


def test_numbers_are_drawn_where_they_are_asked_for_and_none_twice() -> None:
    drawn = list(_drawn([NUMBER, NAN, WHOLE, 7, *[WHOLE] * 50], Random("seed")))
    assert isinstance(drawn[0], float)
    assert same(drawn[1], NAN)
    assert drawn[3] == 7
    assert len(set(drawn[4:])) == 50


def door() -> Exercise:
    """A state that is refused where it is so already."""

    def step(state: bool, asked: bool) -> tuple[bool, dict[str, Any]]:
        return asked, {"success": True} if asked != state else {"success": False, "message": SOME_TEXT}

    machine = Machine("a.b", "A", "B", state=False, step=step, asks=(True, True, False), late_after=2)
    machine.replies("success", 4, "Success")
    machine.replies("message", 2, "Refuses")
    machine.once_at_each_change("once", 2, "Once")
    machine.late_joiner_gets_the_last("late", 2, "Late")
    machine.wrong("stays_so", lambda _, asked: (asked, {"success": True}), "Always.", "Compare.")
    machine.told_too_often()
    machine.not_latched()
    return machine.exercise()


def run(replies: Sequence[tuple[bool, str]], told: Sequence[tuple[int, int, bool]]) -> list[Event]:
    """The calls with these replies, and messages: after which call, their number, and what they tell."""
    events = []
    for call, (asked, (success, message)) in enumerate(zip((True, True, False), replies, strict=False), 1):
        events += [
            event("asked", {"data": asked}),
            event("answered", {"success": success, "message": message}),
        ]
        events += [event("message", {"data": state}, number=n) for after, n, state in told if after == call]
    return events


USUAL = run([(True, ""), (False, "so already"), (True, "")], [(2, 1, True), (3, 2, False)])


@pytest.mark.parametrize(
    ("seen", "failed", "told"),
    [
        (USUAL, set(), set()),
        (USUAL[:5], {"success", "message", "once", "late"}, set()),
        (
            run([(True, ""), (True, ""), (True, "")], [(2, 1, True), (3, 2, False)]),
            {"success", "message"},
            {"stays_so"},
        ),
        (
            run([(True, ""), (False, " "), (True, "")], [(2, 1, True), (3, 2, False)]),
            {"message"},
            set(),
        ),
        (
            run([(True, ""), (False, "no"), (True, "")], [(2, 2, True), (3, 3, False)]),
            {"once"},
            {"told_too_often"},
        ),
        (run([(True, ""), (False, "no"), (True, "")], [(3, 2, False)]), {"late"}, set()),
    ],
)
def test_a_machine_is_judged_by_its_steps(seen: Sequence[Event], failed: set[str], told: set[str]) -> None:
    assert {name for name, holds in passed(door(), seen, USUAL).items() if not holds} == failed
    assert diagnoses(door(), seen) == told


def test_the_ready_made_mistakes_are_explained_to_students() -> None:
    page = (Path(__file__).parents[2] / "docs/mistakes.md").read_text(encoding="utf-8")
    for key in ("not_copied", "too_early", "told_too_often", "not_latched"):
        assert f"### `{key}`\n" in page


def test_nan_is_nan_and_some_text_is_any_text_but_a_blank_one() -> None:
    assert same([NAN, {"a": SOME_TEXT}], [NAN, {"a": "any"}])
    assert not same(SOME_TEXT, " ")
    assert not same(NAN, 1.0)
    assert same(1.0, 1.05, 0.1)
    assert not same(1.0, 1.05)
