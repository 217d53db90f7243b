"""Lab 2.1, a map that grows: the judge subscribes late, and gets the newest one all the same."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, To


def wall(random: Random) -> To:
    """Return a point inside of a cell."""
    return To("/wall", {"x": random.randrange(6) + random.uniform(0.1, 0.9), "y": random.randrange(4) + 0.5})


EXERCISE = SameAsSolution(
    "lab_2_1.map",
    "Lab 2.1 · A map for those who come late",
    "Publish a map that late subscribers get, and publish it again when a wall is met.",
    gives=lambda random: [wall(random) for _ in range(6)],
    tells={"/map": ("info.width", "info.height", "data")},
    late_after=1.0,
    every=True,
).exercise(
    text={
        "whose last message late subscribers get, and publish `self.map` at once": "map",
        "it sets the point's cell to 100, and publishes the map again": "map",
    }
)
