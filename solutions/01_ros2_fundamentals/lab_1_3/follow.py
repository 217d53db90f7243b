"""Lab 1.3, a robot that follows or stays: a service decides what each scan is answered with."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, To

AHEAD = {"far": (0.95, 3.0), "near": (0.1, 0.65)}
COURSE = (
    "far",
    True,
    "far",
    "near",
    "far",
    False,
    "far",
    "near",
    True,
    "near",
    "far",
    True,
    "far",
    False,
    "far",
)
"""The steps: a truth value is a request, a distance is a scan."""
RAYS = 36


def step(kind: str | bool, random: Random) -> To:
    """Return a request, or a scan whose first ray is far or near."""
    if isinstance(kind, bool):
        return To("/follow", {"data": kind})
    sides = [random.uniform(0.1, 3.0) for _ in range(RAYS - 1)]
    return To("/scan", {"ranges": [random.uniform(*AHEAD[kind]), *sides]})


EXERCISE = SameAsSolution(
    "lab_1_3.follow",
    "Lab 1.3 · Follow or stay",
    "Serve follow, and answer each scan with a command: drive only while the robot follows and the wall is far.",
    gives=lambda random: [step(kind, random) for kind in COURSE],
    tells={"/cmd_vel": ("linear.x", "angular.z"), "/follow": ("success", "message")},
    every=True,
    roles=("service", "publisher", "subscription"),
).exercise(
    text={
        "Let the node offer the service `follow`.": "follow",
        "Each answer has `success` true and the `message` `following` or `staying`.": "follow",
        "A request with `data` true lets it follow, and one with `data` false lets it stay.": "cmd_vel",
        "At the beginning it stays": "cmd_vel",
    }
)
