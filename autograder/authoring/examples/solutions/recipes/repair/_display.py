"""The exercise that judges the repaired display: it does the same as the solution."""

from autograder.kit import SameAsSolution, To

EXERCISE = SameAsSolution(
    "repair._display",
    "A repair · The display",
    "Show each number.",
    gives=lambda random: [To("/number", random.randrange(100)) for _ in range(5)],
    tells={"/shown": "data"},
    every=True,
).exercise()
