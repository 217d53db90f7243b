"""Plain Python: what a thermostat decides for one temperature after the other."""

from autograder.kit import Returns

EXERCISE = Returns(
    "function.thermostat",
    "Plain Python · The thermostat",
    "Decide for each temperature whether to heat.",
    gives=lambda random: [random.uniform(*random.choice(((5, 17), (19, 20), (22, 30)))) for _ in range(16)],
).exercise(
    text={
        "Heat from below 18 degrees on, and stop above 21 degrees.": "returned",
        "In between, go on as before": "returned",
    }
)
