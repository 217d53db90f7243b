"""A hub: two topics in, one out, and a service that changes what is published."""

from random import Random

from autograder.kit import SameAsSolution, To, shuffled

LIGHT, HEAVY, TARE = (1, 200), (300, 500), To("/tare", {})


def weight(random: Random, place: str, grams: tuple[int, int]) -> To:
    """Return what a scale weighs."""
    return To(place, random.randint(*grams))


def loads(random: Random) -> list[To]:
    """Return weights and calls: one scale alone at first, then three loads, each tared; the last weight comes twice."""
    one, other = shuffled(random, ["/left", "/right"])
    steps = [TARE, weight(random, one, LIGHT), TARE, weight(random, one, LIGHT)]
    for grams in random.choice([(LIGHT, HEAVY, LIGHT), (HEAVY, LIGHT, HEAVY)]):
        steps += [weight(random, other, grams), weight(random, one, grams), TARE]
        steps += [weight(random, other, grams)] * 2
    return steps


EXERCISE = SameAsSolution(
    "hub.scales",
    "Two topics and a service · The scales",
    "Publish the sum of two scales, less what was tared.",
    gives=loads,
    tells={"/total": "data", "/tare": "success"},
    every=True,
    roles=("subscription", "publisher", "service"),
).exercise(
    text={
        "publish the sum of the newest weights of both scales": "total",
        "Let `success` be": "tare",
    }
)
