"""Lab 2.0, an agent without ROS: what a new one decides for one observation after the other."""

from random import Random

from autograder.kit.oracle.returns import Returns

AHEAD = {"far": (1.1, 3.0), "between": (0.65, 0.95), "near": (0.2, 0.55)}
COURSE = (
    "between",
    "far",
    "between",
    "near",
    "between",
    "near",
    "far",
    "between",
    "near",
    "near",
    "between",
    "far",
    "near",
)
"""Where the wall ahead is. Between the two distances, only what was decided before says what is right.

So a new agent drives at the first wall, and one that has seen the last wall turns.
"""


def observation(number: int, wall: str, random: Random) -> list[float]:
    """Return what is seen: more room on the left, then more on the right, and so on; at the last wall, equal room."""
    sides = sorted(random.sample((0.5, 0.9, 1.4, 2.0), 2), reverse=number % 2 == 0)
    if number == len(COURSE) - 1:
        sides = [1.0, 1.0]
    return [round(random.uniform(*AHEAD[wall]), 2), *sides]


EXERCISE = Returns(
    "lab_2_0.agent",
    "Lab 2.0 · An agent that explores",
    "Return the command for each observation: drive ahead, and turn away in front of a wall.",
    gives=lambda random: [observation(number, wall, random) for number, wall in enumerate(COURSE)],
).exercise(
    text={
        "If it turns, and the wall ahead is farther than 1 meter, it stops turning.": "returned",
        "nearer than 0.6 meters, it begins to turn": "returned",
        "`Command(turn=self.turn)` while it turns": "returned",
    }
)
