"""The chapter in short: a brake that hears a best-effort sensor, and says for each distance whether to brake."""

from random import Random

from autograder.kit import SameAsSolution, To, levels, mixed

NEAR = 0.5
"""The distance in meters below which the brake is on. At the distance itself, which every float holds, it is off."""
AROUND = 0.99, 1.01
"""How far from a level a distance is drawn, so that no table of distances that were seen helps."""


def distances(random: Random) -> list[To]:
    """Return distances near all levels, some of them twice, and the limit itself."""
    around = [level * random.uniform(*AROUND) for level in (*levels(NEAR), *levels(NEAR)[2:5])]
    order = mixed(random, [NEAR, *around], lambda meters: meters < NEAR)
    return [To("/distance", round(meters, 4)) for meters in order]


EXERCISE = SameAsSolution(
    "quiz.brake",
    "The chapter in short · A brake that hears its sensor",
    "Hear a sensor that offers best effort, and say for each distance whether to brake.",
    gives=distances,
    tells={"/brake": "data"},
    qos=["/distance"],
    every=True,
).exercise(
    text={
        "subscribes to `distance` so that it hears this sensor": "brake",
        "publishes one `Bool` on `brake` for each message, which is true if the distance is less than 0.5": "brake",
    },
    counts={
        "": "Any profile that hears a best-effort publisher counts, but *best available* may be chosen too early."
    },
)
