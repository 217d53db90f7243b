"""A relay: what is heard is said again in another unit, as a parameter and a service will have it."""

from random import Random

from autograder.kit import SameAsSolution, Sets, To, shuffled

REQUESTS = ((True, False, False, True, False), (False, False, True, True, False))
"""Requests that switch the converter, and requests for the present state, which it refuses."""


def day(random: Random) -> list[To | Sets]:
    """Return requests, and after each of them another offset and temperatures: one twice, and nan."""
    steps: list[To | Sets] = []
    for is_on in random.choice(REQUESTS):
        once, twice = random.uniform(-40.0, 100.0), random.uniform(-40.0, 100.0)
        steps += [To("/power", {"data": is_on}), Sets("offset", random.uniform(-9.0, 9.0))]
        for group in shuffled(random, [[once], [twice, twice], [float("nan")]]):
            steps += [To("/celsius", celsius) for celsius in group]
    return steps


EXERCISE = SameAsSolution(
    "relay.converter",
    "A relay · The converter",
    "Publish each temperature in degrees Fahrenheit, with an offset, while the converter is on.",
    gives=day,
    tells={"/fahrenheit": "data", "/power": ("success", "message?"), "/is_on": "data"},
    every=True,
    qos=("/is_on",),
    parameters=("offset",),
    roles=("subscription", "publisher", "service"),
).exercise(
    text={
        "nine fifths of it, and 32 more": "fahrenheit",
        "Publish nothing for `nan`": "fahrenheit",
        "The parameter `offset`": "fahrenheit offset",
        "While it is off, nothing is published on `fahrenheit`": "fahrenheit",
        "`success` is true if this changes it": "power",
        "Publish each change once on `is_on`": "is_on",
        "a node that subscribes later hears the last one": "is_on",
    }
)
