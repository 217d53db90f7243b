"""Lab 1.2, a robot that stops before the wall: each scan is answered by a command."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, To

AHEAD = {"far": (0.95, 3.0), "near": (0.1, 0.65)}
COURSE = ("far", "far", "near", "near", "far", "near", "far", "near", "near", "far")
RAYS = 36


def scan(distance: str, random: Random) -> To:
    """Return a scan whose first ray is far or near; the other rays may be either."""
    sides = [random.uniform(0.1, 3.0) for _ in range(RAYS - 1)]
    return To("/scan", {"ranges": [random.uniform(*AHEAD[distance]), *sides]})


EXERCISE = SameAsSolution(
    "lab_1_2.wall",
    "Lab 1.2 · Stop before the wall",
    "Answer each scan with a command: drive while the wall ahead is far, stand still when it is near.",
    gives=lambda random: [scan(distance, random) for distance in COURSE],
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    every=True,
).exercise(
    text={
        "For each message on `/scan` it publishes one `Twist` on `/cmd_vel`": "cmd_vel",
        "wall ahead is farther away than 0.8 m": "cmd_vel",
    }
)
