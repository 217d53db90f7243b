"""Exercise 1.2, a robot's lamp: a client in a callback calls once for each change, and does not wait there."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from random import Random

from autograder.kit import Mission, Moment, Pose, World, drawn_until, levels, mixed
from autograder.kit.rules import value

DOOR, NEAR = 4.0, 1.0
"""Where the door is, as x in meters, and how near the robot has to be, in meters."""
STAYS = 0.6
"""Seconds for which the robot stays at a place."""
Call = tuple[float, bool]
"""The x of the robot, and whether the lamp is to be on from there."""
RIGHT = "once for each change, before the robot goes on"
"""What is said of all right calls."""


def is_near(x: float, near: float = NEAR, sides: Sequence[int] = (-1, 1)) -> bool:
    """Return True if the lamp has to be on at a place; or if a node takes it for near that looks at one side only."""
    return any(0.0 <= side * (x - DOOR) < near for side in sides)


def tells(order: Sequence[float]) -> bool:
    """Return True if the lamp changes just for the two places that are nearest to the limit, and not at the first one.

    With another limit a call is missing there. Next to a place of the same kind it would only be late. A node that does
    not know that the lamp is off at the start calls at the first place, which is far from the door.
    """
    lamp = [False, *map(is_near, order)]
    if lamp[1]:
        return False
    by_distance = sorted(range(len(order)), key=lambda n: abs(abs(order[n] - DOOR) - NEAR))
    return all(lamp[n] != lamp[n + 1] not in lamp[n + 2 : n + 3] for n in by_distance[:2])


def places(random: Random) -> list[World | float]:
    """Return places at all levels around the nearness of the door, on both of its sides, in drawn order."""
    distances, sides = levels(NEAR), [*random.sample((1, 1, -1, -1), 4), *random.sample((1, 1, -1, -1), 4)]
    around = [DOOR + side * far for side, far in zip(sides, distances, strict=True)]
    order = drawn_until(lambda: mixed(random, around, is_near), tells)
    # Only x counts: from each of the places, the middle of the doorway is farther away than a meter.
    beside = [2.0 + random.choice((-1, 1)) * random.uniform(1.05, 1.4) for _ in order]
    return [
        step for x, y in zip(order, beside, strict=True) for step in (World(start=Pose(x, y, 0.0)), STAYS)
    ]


def told(now: Moment) -> list[float]:
    """Return each x that the node was told so far."""
    return [event.data["fields"]["pose"]["pose"]["position"]["x"] for event in now.part.of("sent", "/odom")]


def due(now: Moment, on: Callable[[float], bool] = is_near) -> list[Call]:
    """Return the calls that a rule asks for with what the node was told so far. At the start the lamp is off."""
    states = [False, *map(on, told(now))]
    return [(x, new) for x, (old, new) in zip(told(now), pairwise(states), strict=True) if new != old]


def at_calls(now: Moment) -> list[tuple[Moment, bool]]:
    """Return the moment before each call of the node, and whether the call asked for the lamp to be on."""
    return [
        (replace(now, part=replace(now.part, events=now.part.events[:number])), bool(value(event)))
        for number, event in enumerate(now.part.events)
        if (event.kind, event.name) == ("request", "/lamp")
    ]


def asked(now: Moment) -> list[Call]:
    """Return the calls of the node, each with the x that it was told last."""
    return [(told(before)[-1], on) for before, on in at_calls(now) if told(before)]


def does_as(now: Moment, *rules: Callable[[float], bool]) -> bool:
    """Return True if the lamp was switched as by one of some wrong rules."""
    return any(asked(now) == due(now, rule) != due(now) for rule in rules)


def never_off(now: Moment) -> bool:
    """Return True if the lamp was switched on when it had to be, and stayed on."""
    return asked(now) == due(now)[:1] != due(now)


def other_way_round(now: Moment) -> bool:
    """Return True if the lamp was on elsewhere, and off at the door."""
    return asked(now) == [(x, not on) for x, on in due(now)] != [] or does_as(now, lambda x: not is_near(x))


def one_side(now: Moment) -> bool:
    """Return True if one side of the door was forgotten: the lamp is off there, or on at every distance."""
    beyond = (lambda x: x > DOOR - NEAR, lambda x: x < DOOR + NEAR)
    return does_as(now, partial(is_near, sides=(1,)), partial(is_near, sides=(-1,)), *beyond)


def other_distance(now: Moment) -> tuple[float, float] | None:
    """Return between which two distances that lies with which the lamp was switched; None if with the right one."""
    between = pairwise([0.0, *levels(NEAR)])
    return next((two for two in between if does_as(now, partial(is_near, near=sum(two) / 2))), None)


def calls(now: Moment) -> str:
    """Return in words what was asked of the lamp, in order, if anything is wrong with that."""
    mine, right = ([on for _, on in listed] for listed in (at_calls(now), due(now)))
    called = ", ".join("on" if on else "off" for on in mine) or "no call"
    if mine != right:
        places = ", ".join(f"{'on' if on else 'off'} at x = {x:.3g}" for x, on in due(now))
        return f"{called}; due were {places}"
    if any(mine[: n + 1] != [on for _, on in due(before)] for n, (before, _) in enumerate(at_calls(now))):
        return f"{called}, but the robot was elsewhere then"
    # A node that has ended is told nothing more.
    was_everywhere = len({*told(now)}) == len(levels(NEAR))
    return RIGHT if was_everywhere else f"{called}, and no answer after that"


def delays(random: Random) -> list[float]:
    """Return after how many seconds the lamp answers each call."""
    return [random.choice((0.25, 0.3, 0.35)) for _ in levels(NEAR)]


LAMP = partial(
    Mission,
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
            "Only x counts: compare it with the door's, and call self.lamp.call_async(SetBool.Request(data=...)).",
        ),
        (
            "too_many_calls",
            lambda now: (count := len(now.part.of("request"))) > len(due(now)) and count,
            "Your node called the service lamp {} times, and the lamp had to change less often.",
            "Compare what the lamp has to be, on both sides, with self.is_on; only if they differ, store it, and call.",
            {"certain": True},
        ),
        (
            "never_off",
            never_off,
            "Your node never switches the lamp off.",
            "Call when the lamp has to change, in both directions: data of the request says whether it has to be on.",
            {"late": True},  # a node that hangs in its first call does the same
        ),
        (
            "other_way_round",
            other_way_round,
            "Your lamp is off at the door, and on elsewhere.",
            "Look at the comparison, and at what data of the request says.",
            {"late": True},
        ),
        (
            "one_side",
            one_side,
            "Your node knows only one side of the door: the robot may be near it on both.",
            "abs(x - 4.0) is how far the robot is from the door, on either side.",
            {"late": True},
        ),
        (
            "other_number",
            other_distance,
            "It is as if another number stood in the place of 1 meter (yours: between {0[0]:g} and {0[1]:g}).",
            "Compare the numbers in your code with the task.",
            {"late": True},
        ),
    ],
    within=30.0,
)
"""The mission of the lamp, for the bug hunts about it: they say when it answers."""
# A node that remembers the lamp's state only when the answer comes would ask again meanwhile.
EXERCISE = LAMP(late={"/lamp": delays}).exercise(
    text={
        "Let the lamp be on while the robot is less than 1 meter from the door, at `x = 4`, and off elsewhere.": "lamp",
        "Call the service once for each change, and never more often.": "lamp",
    },
)
