"""Lab 2.3, an agent that thinks long: its decisions about old observations are thrown away."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, Serves, To


def decision(random: Random) -> dict[str, object]:
    """Return a decision that nobody can guess."""
    return {"success": True, "message": f"{random.choice(('left', 'right'))} {random.randrange(1000)}"}


def steps(random: Random) -> list[To | float]:
    """Return observations: one alone, three in a row, and two of which the first is old. Some numbers fall."""
    low, *rest = sorted(random.sample(range(1, 100), 6))
    numbers = [rest[0], *reversed(rest[1:4]), low, rest[4]]
    first, *row, fifth, sixth = (To("/seen", number) for number in numbers)
    return [first, 1.6, *row, 2.1, fifth, 0.6, sixth, 1.6]


EXERCISE = SameAsSolution(
    "lab_2_3.thinks",
    "Lab 2.3 · An agent that thinks long",
    "Let the agent think in a thread of its own, and throw decisions about old observations away.",
    gives=steps,
    tells={"/told": "data", "/beat": "data"},
    serves={"/oracle": Serves(decision, late={1: 1.0, 2: 1.8, 3: 0.8, 4: 0.8, 5: 1.5, 6: 0.8})},
    every=("/told",),
    pause=0.5,
    roles=("publisher", "subscription", "client"),
).exercise(
    text={
        "let `self.agent` decide in a thread of its own": "told beat",
        "if a newer observation has come meanwhile, throw the decision away": "told",
    }
)
