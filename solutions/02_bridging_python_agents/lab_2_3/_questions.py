"""Lab 2.3: what the exercises share: inputs, and answers that nobody can guess, each at its own moment."""

from math import inf
from random import Random

from autograder.kit import To, shuffled

PAUSE = 0.5
"""Seconds of the subject's time after each input."""
OFFSETS = (0.05, 0.1, 0.15, 0.2, 0.25)
"""When an answer comes within one step of 0.5 s: two beats of a heart before its end, so that any heart has said it."""
WAITS = 2
"""The number of steps without an input after each row."""
NEVER = inf
PLACES = ("at the door", "in the hall", "at the dock", "by the lamp", "at the desk", "in the shed")
TANGLED, TURNED = ((4, 1, 3), (4, 3, 2), (3, 1, 2), (3, 4, 2)), ((2, 1), (3, 1))
"""In which steps, from the first question on, three answers come, and two: never in the order of the questions."""


def place(random: Random) -> dict[str, object]:
    """Return an answer of the service ``where``."""
    return {"success": True, "message": f"{random.choice(PLACES)}, {random.randrange(100)} m"}


def row(
    random: Random, topic: str, numbers: list[int], steps: tuple[int, ...], pause: float = PAUSE
) -> list[To | float]:
    """Return inputs one after the other, and steps without an input until all are answered.

    Args:
        random: What draws.
        topic: The topic of the inputs.
        numbers: The inputs.
        steps: For each input, the number of the step in which it is answered, counted from 0. They differ: of two
            answers that come close to one another, the heart of a right program may say either first.
        pause: Seconds of the subject's time after each input.
    """
    answered = [
        round((step - asked) * pause + offset, 2)
        for asked, (step, offset) in enumerate(zip(steps, random.sample(OFFSETS, len(steps)), strict=True))
    ]
    return [
        *(To(topic, n, answered=late) for n, late in zip(numbers, answered, strict=True)),
        *[pause] * WAITS,
    ]


def questions(random: Random) -> list[To | float]:
    """Return rows of one question, of two and of three, in drawn order. A number comes again in another row."""
    all_steps = shuffled(random, [(random.choice((0, 1)),), random.choice(TURNED), random.choice(TANGLED)])
    numbers = random.sample(range(1, 100), 3)
    rows = [row(random, "/ask", random.sample(numbers, len(steps)), steps) for steps in all_steps]
    return [step for each in rows for step in each]
