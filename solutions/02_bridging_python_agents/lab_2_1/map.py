"""Lab 2.1, a map that grows: the judge subscribes late, and gets the newest one all the same."""

from random import Random

from autograder.kit import SameAsSolution, To, drawn_until, shuffled

WIDTH, HEIGHT, WALLS = 6, 4, 6
INSIDE = (0.2, 0.8, 0.4, 0.7, 0.3, 0.9)
"""Where in its cell a point is, in both directions: a program that rounds takes the next cell for some of them."""


def walls(random: Random) -> list[To]:
    """Return points in different cells, and at the end one of them again. The first comes before the judge listens."""
    inside = [(x, y) for x in range(WIDTH) for y in range(HEIGHT)]
    # A program that exchanges x and y leaves its list at the last columns, which are more than there are rows.
    cells = drawn_until(lambda: random.sample(inside, WALLS), lambda met: any(x >= HEIGHT for x, _ in met))
    places = zip(cells, shuffled(random, INSIDE), shuffled(random, INSIDE), strict=True)
    met = [To("/wall", {"x": x + right, "y": y + up}) for (x, y), right, up in places]
    return [*met, random.choice(met)]


EXERCISE = SameAsSolution(
    "lab_2_1.map",
    "Lab 2.1 · A map for those who come late",
    "Publish a map that late subscribers get, and publish it again when a wall is met.",
    gives=walls,
    tells={"/map": ("info.width", "info.height", "data")},
    late_after=1.0,
    every=True,
).exercise(
    text={
        "whose last message late subscribers get, and publish `self.map` at once": "map",
        "it sets the point's cell to 100, and publishes the map again": "map",
    }
)
