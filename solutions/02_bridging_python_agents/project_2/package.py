"""The project's package: its launch file starts both programs, with the limits of the mission."""

from math import atan2, cos, pi, sin
from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, Serves, To
from autograder.kit.runners import LaunchesFromPackage

HOME, LAMP = (1.0, 1.0), (3.0, 2.0)


def at(place: tuple[float, float], facing: tuple[float, float], off: float) -> To:
    """Return a position at a place, from which the robot looks at another one, or past it by an angle in radians."""
    heading = atan2(facing[1] - place[1], facing[0] - place[0]) - off
    turned = {"z": sin(heading / 2), "w": cos(heading / 2)}
    return To(
        "/odom", {"pose": {"pose": {"position": {"x": place[0], "y": place[1]}, "orientation": turned}}}
    )


def steps(random: Random) -> list[To | float]:
    """Return the way to the lamp and back, with a position that gets old, and a red button that is pressed.

    Nobody knows whether the judge's clock calls the timer of the question at once, so the way begins after the answer.
    """
    drives, turns = (
        [random.choice((-1, 1)) * random.uniform(*angles) for _ in range(3)]
        for angles in ((0.05, 0.2), (0.8, pi - 0.5))
    )
    way, button = (2.0, random.uniform(1.2, 1.8)), [To("/stop", {"data": data}) for data in (True, False)]
    there = [2.3, at(HOME, LAMP, turns[0]), at(HOME, LAMP, drives[0]), 1.4, at(way, LAMP, drives[1])]
    stopped = [button[0], at(way, LAMP, drives[1]), button[1], 1.4, at(way, LAMP, turns[1])]
    back = [at((2.9, 2.0), HOME, drives[2]), at(way, HOME, turns[2]), at((1.1, 1.0), HOME, 0.0)]
    return [*there, *stopped, *back]


EXERCISE = SameAsSolution(
    "project_2.package",
    "Project 2 · The package",
    "Start both programs with one launch file, with the limits of the mission.",
    gives=steps,
    tells={"/cmd_vel": ("linear.x", "angular.z"), "/stop": ("success", "message")},
    serves={"/where": Serves(lambda _: {"success": True, "message": "3.0 2.0"})},
    roles=("publisher", "subscription", "client", "service"),
).exercise(
    limit=400.0,
    runner=LaunchesFromPackage("lamp_robot", "lamp.launch"),
    unasked=("/agent_vel",),
    text={
        "It starts both programs, and gives `safe_hands` the limits of this mission": "cmd_vel stop",
        "while `self.lamp` is `None`, call the service, and let the future call `on_answer`": "cmd_vel",
        "the agent decides about": "cmd_vel",
        "Otherwise the robot knows too little: both numbers are 0.": "cmd_vel",
        "Declare the programs `bridge` and `safe_hands`": "cmd_vel stop",
    },
)
