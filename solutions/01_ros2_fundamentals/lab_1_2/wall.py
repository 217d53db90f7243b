"""Lab 1.2, a robot that stops before the wall: each scan is answered by a command."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, To

WALL = {"f": (0.95, 3.0), "n": (0.1, 0.65)}
COURSE = ("fn", "ff", "nf", "nn", "fn", "nf", "ff", "nn", "nf", "fn")
"""Whether the wall is far or near: ahead, and behind the robot. A node that looks the wrong way is told from others."""
RAYS = 36


def scan(walls: str, random: Random) -> To:
    """Return a scan whose first ray is straight ahead; those at the sides may be long or short."""
    ahead, behind = (random.uniform(*WALL[kind]) for kind in walls)
    left, right = ([random.uniform(0.1, 3.0) for _ in range(RAYS // 2 - 1)] for _ in range(2))
    return To("/scan", {"ranges": [ahead, *left, behind, *right]})


EXERCISE = SameAsSolution(
    "lab_1_2.wall",
    "Lab 1.2 · Stop before the wall",
    "Answer each scan with a command: drive while the wall ahead is far, stand still when it is near.",
    gives=lambda random: [scan(walls, random) for walls in COURSE],
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    every=True,
).exercise(
    text={
        "For each message on `/scan` it publishes one `Twist` on `/cmd_vel`": "cmd_vel",
        "wall ahead is farther away than 0.8 m": "cmd_vel",
    }
)
