"""Exercise 1.2, a robot's lamp: a client in a callback calls once for each change, and does not wait there."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from random import Random

from autograder.kit import Mission, Moment, Pose, World, drawn_until, levels, mixed
from autograder.kit.rules import value

DOOR, NEAR = 4.0, 1.0
"""Where the door is, as x in meters, and how near the robot has to be, in meters."""
STAYS = 0.6
"""Seconds for which the robot stays at a place."""
RIGHT = "once for each change, before the robot goes on"
"""What is said of all right calls."""


def is_near(x: float) -> bool:
    """Return True if the lamp has to be on at a place."""
    return abs(x - DOOR) < NEAR


def tells(order: Sequence[float]) -> bool:
    """Return True if the lamp changes just for the two places that are nearest to the limit.

    With another limit a call is missing there. Next to a place of the same kind it would only be late.
    """
    lamp = [False, *map(is_near, order)]
    by_distance = sorted(range(len(order)), key=lambda n: abs(abs(order[n] - DOOR) - NEAR))
    return all(lamp[n] != lamp[n + 1] not in lamp[n + 2 : n + 3] for n in by_distance[:2])


def places(random: Random) -> list[World | float]:
    """Return places at all levels around the nearness of the door, on both of its sides, in drawn order."""
    distances, sides = levels(NEAR), [*random.sample((1, 1, -1, -1), 4), *random.sample((1, 1, -1, -1), 4)]
    around = [DOOR + side * far for side, far in zip(sides, distances, strict=True)]
    order = drawn_until(lambda: mixed(random, around, is_near), tells)
    return [step for x in order for step in (World(start=Pose(x, 2.0, 0.0)), STAYS)]


def changes(now: Moment) -> list[float]:
    """Return the x at which the lamp had to change so far: to on, to off, and so on."""
    told = [event.data["fields"]["pose"]["pose"]["position"]["x"] for event in now.part.of("sent", "/odom")]
    return [x for before, x in pairwise([DOOR + 2 * NEAR, *told]) if is_near(x) != is_near(before)]


def calls(now: Moment) -> str:
    """Return in words what was asked of the lamp, in order, if anything is wrong with that."""
    asked: list[bool] = []
    too_early = False
    for number, event in enumerate(now.part.events):
        if (event.kind, event.name) == ("request", "/lamp"):
            asked.append(bool(value(event)))
            before = replace(now, part=replace(now.part, events=now.part.events[:number]))
            too_early |= asked != [*map(is_near, changes(before))]
    told = ", ".join("on" if one else "off" for one in asked)
    places = changes(now)
    if asked != [*map(is_near, places)]:
        due = ", ".join(f"{'on' if is_near(x) else 'off'} at x = {x:.3g}" for x in places)
        return f"{told or 'no call'}; due were {due}"
    if too_early:
        return f"{told}, but the robot was elsewhere then"
    was_everywhere = now.leg + 1 == len(levels(NEAR))
    return RIGHT if was_everywhere else f"{told or 'no call'}, and no answer after that"


EXERCISE = Mission(
    "exercise_1_2.lamp",
    "Exercise 1.2 · The lamp at the door",
    "Switch the robot's lamp on when it comes near the door, and off when it leaves.",
    roles=("client", "subscription"),
    draws=places,
    same=[("Calls once for each change, in time", calls, "lamp", 10)],
    knows=[
        (
            "no_call",
            lambda now: not now.part.of("request") and not now.part.traceback,
            "Your node never called the service lamp, although the robot came near the door.",
            "Compare x with the door's place in on_odom, and call self.lamp.call_async(SetBool.Request(data=...)).",
        ),
        (
            "too_many_calls",
            lambda now: (count := len(now.part.of("request"))) > len(changes(now)) and count,
            "Your node called the service lamp {} times, and the lamp had to change less often.",
            "Compare what the lamp has to be, on both sides of the door, with self.is_on; call only if they differ.",
            {"certain": True},
        ),
    ],
    within=30.0,
).exercise(
    text={
        "Let the lamp be on while the robot is less than 1 meter from the door, at `x = 4`, and off elsewhere.": "lamp",
        "Call the service once for each change, and never more often.": "lamp",
    },
)
