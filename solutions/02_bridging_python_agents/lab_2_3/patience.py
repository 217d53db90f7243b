"""Lab 2.3, a question that is never answered is given up, and a late answer is not said."""

from random import Random

from lab_2_3._questions import NEVER, OFFSETS, PAUSE, place

from autograder.kit import SameAsSolution, To, shuffled

OPEN, GIVEN_UP = 1.45, 0.35
"""Seconds of the subject's time: a question is 1.95 s old after the first of them, and 2.3 s old after both.

The heart beats ten times a second, so a question that is never answered is given up after 2.05 to 2.15 s.
"""


def steps(random: Random) -> list[To | float]:
    """Return questions that are answered at once, just in time, too late, or never, in drawn order.

    The robot's time stands still after the second one, before any can be too late: a node on another clock is noticed.
    """
    numbers = iter(random.sample(range(1, 100), 7))
    in_time, at_once, second = (random.choice(OFFSETS) for _ in range(3))
    open_before: list[To | float] = [
        To("/ask", next(numbers), answered=NEVER),
        To("/ask", next(numbers), 2.2, answered=PAUSE + second),
        *(OPEN - PAUSE, GIVEN_UP),
    ]
    rows: list[list[To | float]] = [
        [To("/ask", next(numbers), answered=at_once)],
        [To("/ask", next(numbers), answered=round(PAUSE + 0.95 + in_time, 2)), OPEN],
        [To("/ask", next(numbers), answered=random.choice((2.4, 2.45, 2.5))), OPEN, GIVEN_UP, PAUSE],
        # Of two that are open, the second one is answered just in time, when the first has been given up.
        [
            To("/ask", next(numbers), answered=NEVER),
            To("/ask", next(numbers), answered=1.85),
            *(OPEN - PAUSE, GIVEN_UP, PAUSE),
        ],
    ]
    return [*open_before, *(step for each in shuffled(random, rows) for step in each)]


EXERCISE = SameAsSolution(
    "lab_2_3.patience",
    "Lab 2.3 · What never comes",
    "Give a question up after two seconds, and say so.",
    gives=steps,
    tells={"/told": "data", "/beat": "data"},
    serves={"/where": place},
    every=("/told",),
    pause=PAUSE,
    roles=("publisher", "subscription", "client"),
).exercise(
    text={
        "open for more than 2 seconds of the robot's time, and says `no answer`": "told",
        "An answer that comes later than that is not said any more.": "told",
        "So the heart looks after the questions: at each beat": "beat",
    }
)
