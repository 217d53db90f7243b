"""Lab 2.3, a library of asyncio beside rclpy: its loop in a thread, and answers that go both ways."""

from random import Random

from lab_2_3._questions import TANGLED, TURNED, place, row

from autograder.kit import SameAsSolution, To, shuffled

PAUSE = 1.0
"""Seconds of the subject's time after each input. An answer comes in their first quarter, and the rest is for the loop.

The way from the executor to the loop and back takes some rounds of both threads, and the judge's clock waits for one.
"""


def steps(random: Random) -> list[To | float]:
    """Return rows of two questions and of three, in drawn order."""
    all_steps = shuffled(random, [random.choice(TURNED), random.choice(TANGLED)])
    numbers = random.sample(range(1, 100), 5)
    rows = [row(random, "/ask", [numbers.pop() for _ in steps], steps, PAUSE) for steps in all_steps]
    return [step for each in rows for step in each]


EXERCISE = SameAsSolution(
    "lab_2_3.library",
    "Lab 2.3 · A library of asyncio",
    "Run a library's coroutines in a loop of their own, and bring ROS's answers there.",
    gives=steps,
    tells={"/told": "data"},
    serves={"/where": place},
    every=True,
    pause=PAUSE,
    roles=("publisher", "subscription", "client"),
).exercise(
    text={
        "begins `self.guide` in the loop, and does not wait for it": "told",
        "calls `where`, and returns the text of the answer": "told",
    },
    # The heart is given, and a callback that waits for its answer stops more than the heart.
    unasked=("/beat",),
)
