"""Lab 2.3, an agent that thinks long: its decisions about old observations are thrown away."""

from random import Random

from lab_2_3._questions import PAUSE, row

from autograder.kit import SameAsSolution, To, shuffled


def decision(random: Random) -> dict[str, object]:
    """Return a decision that nobody can guess."""
    return {"success": True, "message": f"{random.choice(('left', 'right'))} {random.randrange(1000)}"}


def steps(random: Random) -> list[To | float]:
    """Return observations in drawn order: one alone, two and three in a row. Some numbers fall, and some rise.

    In a row, only the decision about the last observation matters. Of three it is the first to come, of two the last.
    An agent that thinks about one after the other says it in a later step.
    """
    one, *numbers = random.sample(range(1, 100), 6)
    fifth, sixth = sorted(numbers[:2])
    falling = sorted(numbers[2:], reverse=True)
    rows = [
        row(random, "/seen", [one], (random.choice((0, 1, 2)),)),
        row(random, "/seen", falling, random.choice(((3, 4, 2), (4, 3, 2)))),
        row(random, "/seen", [fifth, sixth], (2, 3)),
    ]
    return [step for each in shuffled(random, rows) for step in each]


EXERCISE = SameAsSolution(
    "lab_2_3.thinks",
    "Lab 2.3 · An agent that thinks long",
    "Let the agent think in a thread of its own, and throw decisions about old observations away.",
    gives=steps,
    tells={"/told": "data", "/beat": "data"},
    serves={"/oracle": decision},
    every=("/told",),
    pause=PAUSE,
    roles=("publisher", "subscription", "client"),
).exercise(
    text={
        "let `self.agent` decide in a thread of its own": "told beat",
        "if a newer observation has come meanwhile, throw the decision away": "told",
    }
)
