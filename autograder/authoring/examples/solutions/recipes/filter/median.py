"""A filter: some inputs are answered, and each answer depends on several inputs."""

from random import Random

from autograder.kit import SameAsSolution, To

COURSE = "number " * 7 + "nan number nan nan number number"


def measured(kind: str, random: Random) -> To:
    """Return a range, or nan, with a stamp."""
    distance = random.uniform(0.1, 9.0) if kind == "number" else float("nan")
    return To("/range", {"range": distance, "header": {"stamp": {"sec": random.randint(1, 10**6)}}})


EXERCISE = SameAsSolution(
    "filter.median",
    "A filter · The median of five",
    "Publish the median of the last five ranges that are numbers.",
    gives=lambda random: [measured(kind, random) for kind in COURSE.split()],
    tells={"/range_filtered": ("range", "header.stamp.sec")},
    every=True,
).exercise(
    text={
        "the median of the last five ranges that are numbers": "range_filtered",
        "A range that is `nan` is ignored": "range_filtered",
        "Publish nothing before three numbers came": "range_filtered",
        "Copy the stamp": "range_filtered",
    }
)
