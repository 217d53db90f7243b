"""Lab 1.2, a robot that says in which room it is, once for each visit."""

from functools import partial
from itertools import pairwise
from random import Random

from autograder.kit import SameAsSolution, To, drawn_until, levels, mixed

DOOR, END = 4.0, 6.0
"""Where the door is, and where the right room ends: x in meters."""


def steps(random: Random) -> list[To]:
    """Return messages of the robot's odometry. The first comes from the left room, where the robot starts.

    The robot comes into each room once a centimeter behind the door: there, a node must not wait for the
    next place, and no other number that students write is the door's.
    """
    doorsteps = {DOOR - 0.01, DOOR + 0.01}
    places = [*levels(DOOR, below=END), *sorted(doorsteps)]
    places += random.sample(places, 4)
    ways = partial(mixed, random, places, lambda place: place < DOOR)

    def tells(way: list[float]) -> bool:
        entered = {after for before, after in pairwise(way) if (before < DOOR) is not (after < DOOR)}
        return way[0] < DOOR and doorsteps <= entered

    return [
        To("/odom", {"pose": {"pose": {"position": {"x": x, "y": random.uniform(0.5, 3.5)}}}})
        for x in drawn_until(ways, tells)
    ]


EXERCISE = SameAsSolution(
    "lab_1_2.rooms",
    "Lab 1.2 · Say where you are",
    "Say in which room the robot is, whenever it comes into one.",
    gives=steps,
    tells={"/chatter": "data"},
    every=True,
).exercise(
    text={
        "whenever the robot comes into a room, and when the first message arrives": "chatter",
        "`I am in the left room` where `x` is smaller than 4": "chatter",
        "room, the node says nothing": "chatter",
    }
)
