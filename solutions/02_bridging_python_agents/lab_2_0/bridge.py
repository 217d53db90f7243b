"""Lab 2.0, a bridge between a robot and an agent whose commands repeat what it has seen."""

from random import Random

from autograder.kit import SameAsSolution, To

RAYS = 36


def scan(random: Random, distances: int = RAYS) -> To:
    """Return a scan with walls all around. With only one distance the room is round, so the turn is exactly 0."""
    return To("/scan", {"ranges": [random.uniform(0.3, 3.0) for _ in range(distances)] * (RAYS // distances)})


EXERCISE = SameAsSolution(
    "lab_2_0.bridge",
    "Lab 2.0 · The bridge",
    "Let the agent decide about the newest scan, and publish its command five times a second.",
    gives=lambda random: [scan(random), scan(random), 1.3, scan(random), scan(random), scan(random, 1)],
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    rates={"/cmd_vel": 0.2},
).exercise(
    text={
        "a timer calls `self.act` five times a second": "cmd_vel_rate",
        "As long as there is no scan, it does nothing.": "cmd_vel",
        "publishes a `Twist` with the two numbers of the command": "cmd_vel",
    }
)
