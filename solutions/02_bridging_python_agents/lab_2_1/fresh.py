"""Lab 2.1, a driver that knows how old its newest scan is; the judge's laser is best effort."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, To

WALL = {"far": (0.95, 3.0), "near": (0.1, 0.65)}


def scan(wall: str, random: Random, stands: float = 0.0) -> To:
    """Return a scan with a wall ahead, and others around."""
    ranges = [random.uniform(*WALL[wall]), *(random.uniform(0.1, 3.0) for _ in range(35))]
    return To("/scan", {"ranges": ranges}, stands)


EXERCISE = SameAsSolution(
    "lab_2_1.fresh",
    "Lab 2.1 · Fresh or old",
    "Say how old the newest scan is, and drive only while it is fresh and the wall ahead is far.",
    gives=lambda random: [
        *(0.6, scan("far", random), scan("near", random), scan("far", random, stands=1.2), 1.3),
        scan("near", random),
        *(scan("far", random), scan("far", random), 1.4, 0.6, scan("far", random)),
    ],
    tells={"/known": "data", "/cmd_vel": "linear.x"},
    rates={"/known": 0.2, "/cmd_vel": 0.2},
    qos=["/scan"],
    pause=0.6,
).exercise(
    text={
        "returns `nothing` as long as no scan has come": "known",
        "`fresh` if the newest one came less than 1 second of the robot's time ago": "known",
        "which the timer calls five times a second": "known_rate cmd_vel_rate",
        "drives ahead with 0.4 if the": "cmd_vel",
        "Otherwise it publishes `Twist()`.": "cmd_vel",
    }
)
