"""No verdict of a mission depends on the world that was drawn: slow robots and wrong limits, on paper."""

from __future__ import annotations

import math
from importlib import import_module
from random import Random
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.evidence import Evidence
from tests.kit.test_mission import LASER, ODOMETRY, TWIST, Ros

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.model import Exercise

    Subject = Callable[[Ros], object]

RIGHT: str = import_module("exercise_1_2.lamp").RIGHT
"""What is noted of a lamp that is switched as it has to be."""
SEEDS = range(8)
ENDS: dict[str, dict[str, dict[str, str]]] = {
    "lab_2_0.explorer": {"publisher": {"/cmd_vel": TWIST}, "subscription": {"/scan": LASER}},
    "bugs_2._remote": {"publisher": {"/cmd_vel": TWIST}, "subscription": {"/remote": TWIST}},
    "exercise_1_2.lamp": {"client": {"/lamp": "std_srvs/srv/SetBool"}, "subscription": {"/odom": ODOMETRY}},
    "exercise_1_3.wall": {
        "action_client": {"/walk_to": "small_robot_interfaces/action/WalkTo"},
        "subscription": {"/scan": LASER},
    },
}


class World(Ros):
    """A bench without ROS whose worlds are drawn from a seed."""

    def __init__(self, answer: Subject, interface: dict[str, dict[str, str]], seed: int) -> None:
        super().__init__(answer, interface)
        self.random = Random(seed)

    def serve_action(self, action: str, kind: str) -> Any:
        """Let a walk end, too."""

        def finish(status: str, **fields: Any) -> None:
            self.record("result", action, status=status, fields=fields)

        return SimpleNamespace(**vars(super().serve_action(action, kind)), finish=finish)


def explores(pace: float, right: float = -1.0) -> Subject:
    """Return the explorer of Lab 2.0, so many times as fast as the solution; ``right`` is what it does for right."""
    turn = 0.0

    def answer(ros: Ros) -> None:
        nonlocal turn
        if not (scan := ros.heard.get("/scan")):
            return
        rays = scan["ranges"]
        ahead, left, other = min([*rays[-3:], *rays[:4]]), min(rays[7:12]), min(rays[25:30])
        if turn and ahead > 1.0:
            turn = 0.0
        elif not turn and ahead < 0.6:
            turn = 1.0 if left > other else right
        ros.command(0.0 if turn else 0.4 * pace, turn * pace)

    return answer


def passes_on(pace: float) -> Subject:
    """Return the driver of the bug hunt, so many times as fast as the tablet says; it stops if the tablet is silent."""

    def answer(ros: Ros) -> None:
        sent = [event for event in ros.events if event.kind == "sent"]
        speaks = bool(sent) and ros.moment - sent[-1].moment < 0.6
        ros.command(pace * sent[-1].data["fields"]["linear"]["x"] if speaks else 0.0)

    return answer


def switches(limit: float) -> Subject:
    """Return the lamp of Exercise 1.2, with a limit in meters from the door."""
    is_on = False

    def answer(ros: Ros) -> None:
        nonlocal is_on
        if odom := ros.heard.get("/odom"):
            near = abs(odom["pose"]["pose"]["position"]["x"] - 4.0) < limit
            if near is not is_on:
                is_on = near
                ros.record("request", "/lamp", fields={"data": near})

    return answer


def cancels(limit: float) -> Subject:
    """Return the walk of Exercise 1.3, with a limit in meters from the wall."""

    def answer(ros: Ros) -> None:
        kinds = [event.kind for event in ros.events]
        if "goal" not in kinds:
            ros.record("goal", "/walk_to", fields={"x": 5.5, "y": 2.0})
        scan = ros.heard.get("/scan")
        if scan and scan["ranges"][0] < limit and "cancel" not in kinds:
            ros.record("cancel", "/walk_to")

    return answer


def verdicts(exercise_id: str, subject: Callable[[], Subject]) -> set[tuple[bool, ...]]:
    """Return which lines of what must be reached hold, in all worlds."""
    exercise: Exercise = import_module(exercise_id).EXERCISE
    found = set()
    for seed in SEEDS:
        bench = World(subject(), ENDS[exercise_id], seed)
        exercise.scenario(bench)  # type: ignore[arg-type]
        evidence = Evidence([bench.seen()], bench.reference)
        noted = [event for event in evidence.main.of("noted") if "holds" in event.data]
        told = [event.data["text"] == RIGHT for event in evidence.main.of("noted", "lamp")]
        found.add((*(event.data["holds"] for event in noted), *told))
    return found


PACES = (1.0, 0.5, 0.3)


@pytest.mark.parametrize("pace", PACES)
def test_a_slow_robot_gets_the_same_points_in_each_world(pace: float) -> None:
    assert len(verdicts("bugs_2._remote", lambda: passes_on(pace))) == 1


@pytest.mark.parametrize("pace", PACES)
def test_an_explorer_passes_however_slow_it_is(pace: float) -> None:
    (lines,) = verdicts("lab_2_0.explorer", lambda: explores(pace))
    assert all(lines)


def test_an_explorer_that_always_turns_left_gets_no_points_for_the_right() -> None:
    found = verdicts("lab_2_0.explorer", lambda: explores(1.0, right=1.0))
    assert not any(lines[1] or lines[2] for lines in found)


@pytest.mark.parametrize("limit", [0.9, 1.0, 1.1, 1.25, 1.5, 1.6, 1.75, 1.8, 2.0, 2.2])
def test_a_limit_is_right_or_wrong_in_each_world(limit: float) -> None:
    assert len(verdicts("exercise_1_3.wall", lambda: cancels(limit))) == 1


@pytest.mark.parametrize("limit", [0.5, 0.75, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, math.inf])
def test_a_lamp_s_limit_shows_in_each_world(limit: float) -> None:
    assert verdicts("exercise_1_2.lamp", lambda: switches(limit)) == {(limit == 1.0,)}
