"""The exercise that judges the runaway: a remote control drives the robot, falls silent, and drives it again."""

from itertools import pairwise

from autograder.kit import Mission, Moment, Pose, To, World

GAPS, SILENCE = (0.4, 0.3, 0.4, 0.4, 0.2) * 2, 3.5
"""Seconds between two commands, as a radio brings them, and seconds without a command.

The gaps differ, so that a command that is forgotten at regular times is forgotten in the middle of one of them.
"""
TURNS = (-0.2, 0.2)
"""Radians per second that a command turns the robot while it drives."""
SPEAKS = 0.45
"""The remote control still speaks if no gap is longer, in seconds; on a busy machine, one may be."""
GUARD = 1.75
"""A robot stands later only by its own guard, after a second with commands and another one without any, in seconds."""


def held(speed: float, turn: float) -> list[To | float]:
    """Return the steps of a remote control that speaks at least twice a second, but not evenly.

    Each command turns the robot a little, too, so that a robot that goes on turning does not stand.
    """
    command = {"linear": {"x": speed}, "angular": {"z": turn}}
    return [step for gap in GAPS for step in (To("/remote", command), gap)]


def driven(now: Moment) -> float:
    """Return how many meters the robot has driven in this world."""
    return now.pose.x - now.world.start.x


def spoke(now: Moment) -> list[float]:
    """Return when the remote control sent its commands, in seconds since the first one, with which a mission begins."""
    sent = [event.moment for event in now.part.of("sent", "/remote")]
    return [moment - sent[0] for moment in sent]


def stood_after(now: Moment) -> float:
    """Return how many seconds after the last command of the remote control the robot stood."""
    return now.time - now.stood - spoke(now)[-1]


def stutters(now: Moment) -> bool:
    """Return True if the robot has driven in this world and stands, although the remote control speaks."""
    gaps = [late - early for early, late in pairwise([*spoke(now)[-2:], now.time])]
    return bool(gaps) and max(gaps) < SPEAKS and driven(now) > 0 and now.stood > 0.0


EXERCISE = Mission(
    "bugs_2._remote",
    "Bug hunt 2 · The driver",
    "Pass the commands on, and let the robot stand if none come.",
    roles=("publisher", "subscription"),
    draws=lambda random: [
        step
        for steps in (held(0.5, random.choice(TURNS)), [SILENCE], held(0.4, random.choice(TURNS)), [])
        for step in (World(start=Pose(random.uniform(0.8, 1.0), 2.0, 0.0)), *steps)
    ],
    reaches=[
        ("Drives while the tablet speaks", lambda now: now.leg == 0 and driven(now) > 0.8),
        (
            "Stands while the tablet is silent",
            lambda now: now.leg == 1 and now.stood > 1.0 and stood_after(now) < GUARD,
        ),
        ("Drives again when the tablet speaks again", lambda now: now.leg == 2 and driven(now) > 0.8),
    ],
    never=[("Never stands between two commands of the tablet", stutters)],
).exercise()
