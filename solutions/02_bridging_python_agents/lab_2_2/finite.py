"""Lab 2.2, not a number: a command that is not finite is not handed on, and does not set the watchdog back."""

from math import inf, nan
from random import Random

from autograder.kit import SameAsSolution, To, shuffled

PAUSE = 0.35
"""Seconds of the subject's time after each input: after the second one without a command, the watchdog has stopped the
robot, and one that was set back by the first of them stops it in the third."""


def drives(random: Random) -> To:
    """Return a command within the limits."""
    forward, turn = (random.choice((-1, 1)) * random.uniform(0.1, 0.4) for _ in range(2))
    return To("/agent_vel", {"linear": {"x": forward}, "angular": {"z": turn}})


def bad(random: Random, number: float, *, forward: bool) -> To:
    """Return a command of which one number is not finite, and the other one is within the limits."""
    other = random.choice((-1, 1)) * random.uniform(0.1, 0.4)
    x, z = (number, other) if forward else (other, number)
    return To("/agent_vel", {"linear": {"x": x}, "angular": {"z": z}})


def steps(random: Random) -> list[To | float]:
    """Return rounds in drawn order: after a command comes each bad one, alone, many times, and behind the button."""
    pressed, released = (To("/stop", {"data": data}) for data in (True, False))
    kinds = [(number, forward) for number in (nan, inf, -inf) for forward in (True, False)]
    rounds: list[list[To | float]] = [
        [drives(random), bad(random, number, forward=forward), PAUSE] for number, forward in kinds
    ]
    many = [bad(random, number, forward=forward) for number, forward in shuffled(random, kinds)[:3]]
    rounds += [
        # The watchdog sleeps, so a node that sends zeros for a bad command is noticed.
        [drives(random), *many, bad(random, nan, forward=random.choice((True, False)))],
        [drives(random), pressed, bad(random, random.choice((nan, inf)), forward=True), released, *many[:1]],
        [drives(random), To("/agent_vel", {"linear": {"x": nan}, "angular": {"z": nan}}), PAUSE],
    ]
    first = bad(random, random.choice((nan, inf, -inf)), forward=random.choice((True, False)))
    return [first, *(step for each in shuffled(random, rounds) for step in each), drives(random)]


EXERCISE = SameAsSolution(
    "lab_2_2.finite",
    "Lab 2.2 · Not a number",
    "Hand on only commands whose numbers are finite, and let nothing else set the watchdog back.",
    gives=steps,
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    every=True,
    pause=PAUSE,
    roles=("service", "publisher", "subscription"),
).exercise(
    text={
        "return before it if the command is": "cmd_vel",
        "publish nothing for it": "cmd_vel",
        "do not set the watchdog back": "cmd_vel",
    }
)
