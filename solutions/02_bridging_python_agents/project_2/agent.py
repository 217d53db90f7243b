"""The project's agent without ROS: what a new one decides for one observation after the other."""

from math import cos, pi, remainder, sin, tau
from random import Random
from typing import Any

from autograder.kit.oracle.returns import Returns

AT_HOME, CLOSE, AWAY, FAR = (0.0, 0.0), (0.05, 0.25), (0.35, 0.45), (0.8, 1.2)
MISSION = (
    *(("home", AT_HOME), ("home", AWAY), ("home", CLOSE), ("lamp", FAR), ("lamp", FAR), ("lamp", AWAY)),
    *(("lamp", CLOSE), ("lamp", CLOSE), ("lamp", FAR), ("home", FAR), ("home", AWAY), ("home", AWAY)),
    *(("home", CLOSE), ("home", AWAY), ("lamp", FAR), ("lamp", CLOSE)),
)
"""Which place is near, and how near in meters. The lamp is known from the third observation on."""


def mission(random: Random) -> list[list[Any]]:
    """Draw a home and a lamp, and what a robot sees that faces the place next to it, or looks elsewhere, by turns."""
    places = {
        "home": (round(random.uniform(0.5, 1.5), 2), round(random.uniform(0.5, 3.5), 2)),
        "lamp": (round(random.uniform(4.0, 5.5), 2), round(random.uniform(0.5, 3.5), 2)),
    }
    seen: list[list[Any]] = []
    for number, (place, near) in enumerate(MISSION):
        away, around = random.uniform(*near), random.uniform(-pi, pi)
        off = random.choice((-1, 1)) * (random.uniform(0.8, 2.5) if number % 2 else random.uniform(0.05, 0.2))
        (x, y), heading = places[place], remainder(around + pi + off, tau)
        lamp = list(places["lamp"]) if number > 1 else None
        pose = (x + away * cos(around), y + away * sin(around), heading)
        seen.append([*(round(number, 2) for number in pose), lamp])
    return seen


EXERCISE = Returns(
    "project_2.agent",
    "Project 2 · The agent",
    "Decide for each observation of a mission: go to the lamp, come back, and stand.",
    gives=mission,
).exercise(
    text={
        "keep its `(x, y)` in `self.home`": "returned",
        "`search` becomes `go` when the observation has a lamp.": "returned",
        "`go` becomes `back` when the lamp is nearer than 0.3 meters.": "returned",
        "`back` becomes `done` when home is nearer than 0.3 meters.": "returned",
        "`done` remains.": "returned",
        "towards the lamp in `go`, towards home in `back`, and otherwise `Command()`": "returned",
    }
)
