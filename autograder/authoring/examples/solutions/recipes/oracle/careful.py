"""A node whose rule stands in the solution alone: the judge gives both the same scans and compares what they say."""

from random import Random

from autograder.kit import SameAsSolution, To, dealt, levels, shuffled

NEAR, BETWEEN, FAR = levels(0.5)[1:4], [0.5, levels(0.5)[4], levels(0.8)[3]], levels(0.8)[4:7]
PAUSE = 0.7
"""Seconds without a scan. The judge looks when a scan is 0.75 s and 1.45 s old: far from 1 s and from 1.2 s."""


def scan(distance: float, random: Random) -> To:
    """Return a scan of nine ranges, of which the three in the middle are the front."""
    front = random.sample([distance, 4.0, 5.0], 3)
    left, right = (random.choices((0.1, 3.0), k=3) for _ in range(2))
    return To("/scan", {"ranges": [*left, *front, *right]})


def course(random: Random) -> list[To | float]:
    """Return scans that are near and far in turn, and on each way what lies in between, and a pause."""
    downs, ups = (dealt(random, [*BETWEEN, PAUSE], 3) for _ in range(2))
    turns = zip(shuffled(random, NEAR), ups, shuffled(random, FAR), downs, strict=True)
    steps = [step for near, up, far, down in turns for step in (near, *up, far, *down)]
    return [*(step if step == PAUSE else scan(step, random) for step in steps), 2.3]


EXERCISE = SameAsSolution(
    "oracle.careful",
    "A rule · The careful robot",
    "Drive while the front is free, turn while it is not, and stop while no scan comes.",
    gives=course,
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
