"""Lab 1.2, a robot that says in which room it is, once for each visit."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, To

ROOMS = {"left": (0.5, 3.8), "right": (4.2, 5.5)}
COURSE = ("left", "left", "right", "right", "left", "right", "left", "left", "right", "right")


def position(room: str, random: Random) -> To:
    """Return a message of the robot's odometry from somewhere in a room."""
    place = {"x": random.uniform(*ROOMS[room]), "y": random.uniform(0.5, 3.5)}
    return To("/odom", {"pose": {"pose": {"position": place}}})


EXERCISE = SameAsSolution(
    "lab_1_2.rooms",
    "Lab 1.2 · Say where you are",
    "Say in which room the robot is, whenever it comes into one.",
    gives=lambda random: [position(room, random) for room in COURSE],
    tells={"/chatter": "data"},
    every=True,
).exercise(
    text={
        "whenever the robot comes into a room, and when the first message arrives": "chatter",
        "`I am in the left room` where `x` is smaller than 4": "chatter",
        "room, the node says nothing": "chatter",
    }
)
