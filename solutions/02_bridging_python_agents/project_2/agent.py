"""The project's agent without ROS: what a new one decides for one observation after the other."""

from math import cos, pi, remainder, sin, tau
from random import Random
from typing import Any

from autograder.kit import Returns, levels, shuffled

THERE = 0.3
"""The distance in meters below which the robot is at the lamp, and at home."""
*CLOSE, JUST_THERE = [level for level in levels(THERE) if level < THERE]
NOT_YET, *AWAY = [level for level in levels(THERE) if level > THERE]
FAR, OBSERVATIONS = (0.8, 0.9, 1.0, 1.1, 1.2), 16


def way(random: Random) -> tuple[list[tuple[str, float]], int]:
    """Draw which place is near, and how near in meters; and the number of observations without a lamp.

    Each phase lasts for a drawn time, and has what would end another one. The first observation is from home.
    """
    search = shuffled(random, [("home", random.choice(CLOSE)), ("lamp", random.choice(CLOSE))])
    search = [("home", 0.0), *search[: random.randint(1, 2)]]
    go = [("lamp", NOT_YET), ("lamp", random.choice(AWAY)), ("home", random.choice(CLOSE))]
    back = [
        ("lamp", random.choice(CLOSE)),
        ("home", NOT_YET),
        ("home", random.choice(AWAY)),
        ("home", random.choice(FAR)),
    ]
    done = [
        ("lamp", random.choice(CLOSE)),
        ("home", random.choice(AWAY)),
        *(("lamp", far) for far in FAR[:3]),
    ]
    seen = [*search, ("lamp", random.choice(FAR)), *shuffled(random, go), ("lamp", JUST_THERE)]
    seen += [*shuffled(random, back), ("home", JUST_THERE)]
    return [*seen, *shuffled(random, done)][:OBSERVATIONS], len(search)


def mission(random: Random) -> list[list[Any]]:
    """Draw a home and a lamp, and what a robot sees that faces the place next to it, or looks elsewhere, by turns."""
    places = {
        "home": (round(random.uniform(0.5, 1.5), 2), round(random.uniform(0.5, 3.5), 2)),
        "lamp": (round(random.uniform(4.0, 5.5), 2), round(random.uniform(0.5, 3.5), 2)),
    }
    seen: list[list[Any]] = []
    (near, unlit), first = way(random), random.choice((0, 1))
    for number, (place, away) in enumerate(near):
        around = random.uniform(-pi, pi)
        # A robot that faces the lamp when it gets there is told to drive on by an agent that is one observation late.
        is_off = (number + first) % 2 and (place, away) != ("lamp", JUST_THERE)
        off = random.choice((-1, 1)) * (random.uniform(0.8, 2.5) if is_off else random.uniform(0.05, 0.2))
        (x, y), heading = places[place], remainder(around + pi + off, tau)
        lamp = list(places["lamp"]) if number >= unlit else None
        pose = (x + away * cos(around), y + away * sin(around), heading)
        seen.append([*(round(number, 4) for number in pose), lamp])
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
