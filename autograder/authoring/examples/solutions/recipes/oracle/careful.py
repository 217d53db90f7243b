"""A node whose rule stands in the solution alone: the judge gives both the same scans and compares what they say."""

from random import Random

from autograder.kit import SameAsSolution, To

FRONT = {"near": (0.1, 0.45), "between": (0.55, 0.75), "far": (0.9, 3.0)}
COURSE = (
    "far",
    "between",
    "near",
    "between",
    "far",
    "between",
    "near",
    1.6,
    "between",
    "far",
    2.3,
    "near",
    "far",
)
"""How far the nearest thing in front is in each scan; a number is a pause without a scan, in seconds."""


def scan(distance: str, random: Random) -> To:
    """Return a scan of nine ranges, of which the three in the middle are the front."""
    front = random.sample([random.uniform(*FRONT[distance]), 4.0, 5.0], 3)
    left, right = ([random.uniform(0.1, 3.0) for _ in range(3)] for _ in range(2))
    return To("/scan", {"ranges": [*left, *front, *right]})


EXERCISE = SameAsSolution(
    "oracle.careful",
    "A rule · The careful robot",
    "Drive while the front is free, turn while it is not, and stop while no scan comes.",
    gives=lambda random: [scan(each, random) if isinstance(each, str) else each for each in COURSE],
    tells={"/cmd_vel": ("linear.x", "angular.z"), "/state": "data"},
    rates={"/cmd_vel": 0.2, "/state": 0.2},
).exercise(
    text={
        "Every 0.2 s, publish a `Twist` on `cmd_vel`": "cmd_vel cmd_vel_rate",
        "and the state as `String` on `state`": "state state_rate",
        "turn while it is nearer than 0.5 m": "cmd_vel state",
        "drive again when it is farther away than 0.8 m": "cmd_vel state",
        "stop while the last scan is older than 1 s": "cmd_vel state",
    }
)
