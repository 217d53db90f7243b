"""The chapter in short: a brake that hears a best-effort sensor, and says for each distance whether to brake."""

from autograder.kit.oracle.same_as_solution import SameAsSolution, To

DISTANCES = ((0.6, 3.0), (0.05, 0.4), (0.05, 0.4), (0.6, 3.0), (0.6, 3.0), (0.05, 0.4), (0.6, 3.0))
EXERCISE = SameAsSolution(
    "quiz.brake",
    "The chapter in short · A brake that hears its sensor",
    "Hear a sensor that offers best effort, and say for each distance whether to brake.",
    gives=lambda random: [To("/distance", random.uniform(*meters)) for meters in DISTANCES],
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
