"""Lab 1.2, a robot that stops before the wall: each scan is answered by a command."""

from random import Random

from autograder.kit import SameAsSolution, To, levels, mixed, scans

NEAR = 0.8
"""The distance in meters up to which the robot stands still."""


def steps(random: Random) -> list[To]:
    """Return scans with the wall ahead at all levels, some of them twice."""
    walls = levels(NEAR)
    return scans(random, NEAR, mixed(random, [*walls, *random.sample(walls, 3)], lambda wall: wall > NEAR))


EXERCISE = SameAsSolution(
    "lab_1_2.wall",
    "Lab 1.2 · Stop before the wall",
    "Answer each scan with a command: drive while the wall ahead is far, stand still when it is near.",
    gives=steps,
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    every=True,
).exercise(
    text={
        "For each message on `/scan` it publishes one `Twist` on `/cmd_vel`": "cmd_vel",
        "wall ahead is farther away than 0.8 m": "cmd_vel",
    }
)
