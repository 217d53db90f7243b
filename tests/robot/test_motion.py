"""How the robot moves, what stops it, and what its laser sees in the two rooms."""

from __future__ import annotations

import math

import pytest

from autograder.robot.motion import RADIUS, ROOM, START, Pose, Velocity, move, towards


def driven(pose: Pose, velocity: Velocity, seconds: float) -> Pose:
    for _ in range(round(seconds / 0.1)):
        pose = move(pose, velocity, 0.1, ROOM).pose
    return pose


def test_it_rolls_straight_ahead() -> None:
    assert driven(START, Velocity(0.5), 2.0) == Pose(pytest.approx(2.0), 2.0, 0.0)  # type: ignore[arg-type]


def test_it_turns_to_the_left() -> None:
    turned = driven(START, Velocity(turn=math.pi / 4), 2.0)
    assert turned.point == START.point
    assert turned.heading == pytest.approx(math.pi / 2)


def test_a_circle_closes() -> None:
    around = driven(START, Velocity(0.4, math.tau / 10), 10.0)
    assert math.dist(around.point, START.point) < 0.01


def test_straight_ahead_leads_through_the_door_and_to_the_wall_behind_it() -> None:
    far = move(driven(START, Velocity(0.5), 30.0), Velocity(0.5), 0.1, ROOM)
    assert far.bumped
    assert far.velocity.forward == 0.0
    assert far.pose.x == pytest.approx(ROOM.width - RADIUS, abs=0.06)


@pytest.mark.parametrize("heading", [0.5, 1.5, 2.5, 3.5, 4.5, 5.5])
def test_it_never_gets_into_a_wall_and_always_out_again(heading: float) -> None:
    stuck = driven(Pose(1.0, 2.0, heading), Velocity(1.0), 20.0)
    assert ROOM.clearance(stuck.point) >= RADIUS
    assert math.dist(driven(stuck, Velocity(-0.5), 1.0).point, stuck.point) == pytest.approx(0.5)


@pytest.mark.parametrize("wild", [math.nan, math.inf, -math.inf, 1e300])
def test_a_wild_command_is_cut(wild: float) -> None:
    moved = move(START, Velocity(wild, wild), 0.1, ROOM)
    assert math.dist(moved.pose.point, START.point) <= 0.1 + 1e-9


@pytest.mark.parametrize("heading", [0.0, 1.0, 2.0, 3.0, -1.0, -2.0, -3.0])
def test_it_finds_the_door_whatever_it_looks_at(heading: float) -> None:
    pose = Pose(1.0, 3.0, heading)
    for _ in range(200):
        pose = move(pose, towards(pose, ROOM.door), 0.1, ROOM).pose
        if math.dist(pose.point, ROOM.door) < 0.1:
            return
    pytest.fail(f"it ended at {pose}")


@pytest.mark.parametrize(
    ("angle", "meters"),
    [
        (0.0, 5.0),
        (math.pi / 2, 2.0),
        (math.pi, 1.0),
        (-math.pi / 2, 2.0),
        (math.atan2(1.0, 3.0), math.hypot(3.0, 1.0)),
    ],
)
def test_a_ray_ends_at_the_first_wall_and_goes_through_the_door(angle: float, meters: float) -> None:
    assert ROOM.ranges((1.0, 2.0), (angle,)) == [pytest.approx(meters)]


def test_every_ray_of_every_place_ends() -> None:
    angles = tuple(math.tau * number / 97 for number in range(97))
    for x in (0.3, 2.0, 3.9, 4.1, 5.7):
        for y in (0.3, 2.0, 3.7):
            assert max(ROOM.ranges((x, y), angles)) < math.hypot(ROOM.width, ROOM.height)
