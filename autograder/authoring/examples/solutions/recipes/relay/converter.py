"""A relay: what is heard on one topic is published on another, in another unit."""

from __future__ import annotations

from autograder.kit.draft import Draft
from autograder.kit.model import Pace
from autograder.kit.recipes.own_scenario import Met, OwnScenario, once_met
from autograder.kit.rules import Rule, each

PATIENCE = {Pace.FAST: 2.0, Pace.REAL_TIME: 6.0}
"""Seconds of wall time in which the last temperature must have come."""


def converting(met: Met) -> bool:
    """Publish temperatures that nobody can guess, and wait for what becomes of them."""
    # Multiples of 5 on both sides of 0: in Fahrenheit they are whole numbers, in an order that repeats no message.
    degrees = [0, *(5 * n for n in met.bench.random.sample([-5, -4, -3, 2, 3, 5, 6], 5))]
    for celsius in degrees:
        met.speakers[0].send(data=float(celsius))
    came = met.bench.wait_until(lambda _: met.heard >= len(degrees), PATIENCE[met.bench.pace])
    met.bench.settle()
    return came


conversion = Rule(each(lambda celsius: celsius * 9 / 5 + 32))
converter = Draft(
    "relay.converter",
    "A relay · The converter",
    "Publish each temperature that is heard, in degrees Fahrenheit.",
    subject := OwnScenario(once_met(converting), "subscription", "publisher"),
)
converter.asks(
    "listens", 1, "Subscribes to the right topic, with the right type", subject.has("subscription")
)
converter.asks("speaks", 1, "Publishes on the right topic, with the right type", subject.has("publisher"))
converter.criterion("fahrenheit", 8, "Publishes each temperature in Fahrenheit, in order")(conversion.finding)
converter.knows(
    "offset_forgotten",
    conversion.taken_for(each(lambda celsius: celsius * 9 / 5)),
    "Your node publishes 0 for 0 °C, which is 32 °F.",
    "Add 32 after the multiplication: celsius * 9 / 5 + 32.",
    certain=True,
)
converter.knows(
    "offset_multiplied",
    conversion.taken_for(each(lambda celsius: (celsius + 32) * 9 / 5)),
    "Your node adds 32 first and multiplies that, too.",
    "Multiply first: celsius * 9 / 5 + 32.",
    certain=True,
)
converter.knows(
    "not_converted",
    conversion.taken_for(lambda celsius: celsius),
    "Your node publishes what it hears, as it is.",
    "Publish a message of its own, with celsius * 9 / 5 + 32 in its field data.",
    certain=True,
)
EXERCISE = converter.exercise()
