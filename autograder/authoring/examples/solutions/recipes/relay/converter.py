"""A relay: what is heard on one topic is published on another, in another unit."""

from autograder.kit import SameAsSolution, To

EXERCISE = SameAsSolution(
    "relay.converter",
    "A relay · The converter",
    "Publish each temperature that is heard, in degrees Fahrenheit.",
    gives=lambda random: [
        *(To("/celsius", random.uniform(-40.0, 100.0)) for _ in range(5)),
        *(To("/celsius", 20.0), To("/celsius", 20.0)),
    ],
    tells={"/fahrenheit": "data"},
    every=True,
).exercise(
    text={
        "Subscribe to `celsius`.": "fahrenheit",
        "nine fifths of it, and 32 more": "fahrenheit",
    }
)
