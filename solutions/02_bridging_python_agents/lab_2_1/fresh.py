"""Lab 2.1, a driver that knows how old its newest scan is; the judge's laser is best effort."""

from random import Random

from autograder.kit import SameAsSolution, To, drawn_until, levels, mixed, scans

NEAR = 0.8
"""The distance in meters up to which the robot stands still."""
PAUSE, FRESH, OLD, OLDER = 0.45, 0.5, 0.25, 0.4
"""Seconds of the subject's time after each scan; until a scan is 0.95 s old; until it is 1.2 s old; and 1.6 s.

The subject's timer rings at any moment of its 0.2 s. The four scans that grow old come 2.05 s after one another, so
they meet it at four moments, a quarter of its period apart. One of these shows whatever the subject takes for old at
0.95 s, or for fresh at 1.05 s. What is old stays old: two more rings show a node that says so only once.
"""


def steps(random: Random) -> list[To | float]:
    """Return scans with the wall ahead at all levels; every other one grows old before the next one comes.

    Two of these are far away at least, and one is near.
    The robot's time stands still after the second scan, before any grows old: a node on another clock is noticed there.
    """
    walls = drawn_until(
        lambda: mixed(random, levels(NEAR), lambda wall: wall > NEAR),
        lambda walls: 1 < sum(wall > NEAR for wall in walls[::2]) < 4,
    )
    far = random.choice([wall for wall in walls if wall > NEAR])
    early, still, *told = scans(random, NEAR, [max(walls), far, *walls])
    grow_old: list[list[To | float]] = [
        [old, FRESH, OLD, OLDER, new] for old, new in zip(told[::2], told[1::2], strict=True)
    ]
    start = random.choice((0.5, 0.55, 0.6, 0.65))
    return [start, early, still._replace(stands=1.2), *(step for each in grow_old for step in each)]


EXERCISE = SameAsSolution(
    "lab_2_1.fresh",
    "Lab 2.1 · Fresh or old",
    "Say how old the newest scan is, and drive only while it is fresh and the wall ahead is far.",
    gives=steps,
    tells={"/known": "data", "/cmd_vel": ("linear.x", "angular.z")},
    rates={"/known": 0.2, "/cmd_vel": 0.2},
    qos=["/scan"],
    pause=PAUSE,
).exercise(
    text={
        "returns `nothing` as long as no scan has come": "known",
        "`fresh` if the newest one came less than 1 second of the robot's time ago": "known",
        "which the timer calls five times a second": "known_rate cmd_vel_rate",
        "drives ahead with 0.4 if the": "cmd_vel",
        "Otherwise it publishes `Twist()`.": "cmd_vel",
    }
)
