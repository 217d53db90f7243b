"""Lab 2.2, a watchdog: an agent falls silent, and the robot is stopped once."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, To


def command(random: Random, *, turns: bool = False, stands: float = 0.0) -> To:
    """Return a command below the limits, which drives, or only turns."""
    forward = 0.0 if turns else random.uniform(0.1, 0.4)
    twist = {"linear": {"x": forward}, "angular": {"z": random.uniform(0.1, 0.9)}}
    return To("/agent_vel", twist, stands)


EXERCISE = SameAsSolution(
    "lab_2_2.watchdog",
    "Lab 2.2 · The watchdog",
    "Stop the robot once when no command has come for half a second.",
    gives=lambda random: [
        1.1,
        *(command(random) for _ in range(2)),
        command(random, stands=0.7),
        command(random, turns=True),
        0.45,
        1.4,
        *(command(random) for _ in range(3)),
        0.45,
        command(random),
        0.45,
        1.4,
    ],
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    every=True,
    pause=0.3,
).exercise(
    text={
        "Each command is handed on as before": "cmd_vel",
        "If no command has come for 0.5 seconds of the robot's time, publish one `Twist()`": "cmd_vel",
    }
)
