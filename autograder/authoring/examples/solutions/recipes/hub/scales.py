"""A hub: two topics in, one out, and a service that changes what is published."""

from autograder.kit import SameAsSolution, To

COURSE = "tare left left right right left tare left right tare right left"

EXERCISE = SameAsSolution(
    "hub.scales",
    "Two topics and a service · The scales",
    "Publish the sum of two scales, less what was tared.",
    gives=lambda random: [
        To(f"/{name}", {} if name == "tare" else random.randint(1, 500)) for name in COURSE.split()
    ],
    tells={"/total": "data", "/tare": "success"},
    every=True,
    roles=("subscription", "publisher", "service"),
).exercise(
    text={
        "publish the sum of the newest weights of both scales": "total",
        "Let `success` be": "tare",
    }
)
