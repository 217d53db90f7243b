"""Exercise 1.1, a launch file that lets one driver steer two robots."""

from autograder.kit.oracle.same_as_solution import SameAsSolution, To
from autograder.kit.runners import Launches

EXERCISE = SameAsSolution(
    "exercise_1_1.two_robots",
    "Exercise 1.1 · One driver, two robots",
    "Start one driver and two robots, and let both robots obey the driver.",
    gives=lambda _: [
        To("/speed", 0.3),
        To("/speed", 0.7),
    ],  # one launch is enough: the file cannot see the numbers
    lists={"/left/turns": "data", "/right/turns": "data"},
).exercise(
    unasked=("/drive",),
    limit=400.0,
    runner=Launches(),
    wraps_commands=True,
    text={"so that both robots obey the driver": "left_turns right_turns"},
)
