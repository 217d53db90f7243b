"""Plain Python: what a thermostat decides for one temperature after the other."""

from random import Random

from autograder.kit import Returns, dealt, levels, shuffled

COLD, BETWEEN, WARM = levels(18)[:4], [18, levels(18)[4], levels(21)[3], 21], levels(21)[4:]


def temperatures(random: Random) -> list[float]:
    """Return what is cold and what is warm in turn, and on each way what lies in between."""
    between = [*BETWEEN, *random.sample(BETWEEN, 2)]
    downs, ups = dealt(random, between, len(COLD)), dealt(random, between, len(WARM))
    turns = zip(downs, shuffled(random, COLD), ups, shuffled(random, WARM), strict=True)
    return [degrees for down, low, up, high in turns for degrees in (*down, low, *up, high)] + COLD[:1]


EXERCISE = Returns(
    "function.thermostat",
    "Plain Python · The thermostat",
    "Decide for each temperature whether to heat.",
    gives=temperatures,
).exercise(
    text={
        "Heat from below 18 degrees on, and stop above 21 degrees.": "returned",
        "In between, go on as before": "returned",
    }
)
