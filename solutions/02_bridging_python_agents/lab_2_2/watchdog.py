"""Lab 2.2, a watchdog: an agent falls silent, and the robot is stopped once."""

from random import Random

from autograder.kit import SameAsSolution, To, shuffled

PAUSE = 0.3
"""Seconds of the subject's time after each command."""
SHORT, LONG, VERY_LONG = 0.15, 0.45, 1.4
"""Seconds of silence after that: up to 0.45 s the robot drives on, and after 0.75 s it has been stopped, once."""


def command(random: Random, *, ahead: bool = True, turns: bool = True, stands: float = 0.0) -> To:
    """Return a command below the limits, or zeros."""
    forward, turn = random.uniform(0.1, 0.4) * ahead, random.uniform(0.1, 0.9) * turns
    return To("/agent_vel", {"linear": {"x": forward}, "angular": {"z": turn}}, stands)


def steps(random: Random) -> list[To | float]:
    """Return commands of each kind and silences of each length, in drawn order.

    First come a silence and two commands, and then a command after which the robot's time stands still: a node on
    another clock is noticed there, and one that watches only once is noticed before.
    """
    still = command(random, ahead=False, turns=False)
    rounds: list[list[To | float]] = [
        [command(random), SHORT],
        [command(random, turns=False), LONG],
        [command(random, ahead=False), SHORT, VERY_LONG],
        [still, LONG],
    ]
    drawn = [step for each in shuffled(random, rounds) for step in each]
    begin: list[To | float] = [1.1, command(random), command(random), command(random, stands=0.7)]
    return [*begin, *drawn, command(random), LONG, VERY_LONG]


EXERCISE = SameAsSolution(
    "lab_2_2.watchdog",
    "Lab 2.2 · The watchdog",
    "Stop the robot once when no command has come for half a second.",
    gives=steps,
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    every=True,
    pause=PAUSE,
).exercise(
    text={
        "Each command is handed on as before": "cmd_vel",
        "If no command has come for 0.5 seconds of the robot's time, publish one `Twist()`": "cmd_vel",
    }
)
