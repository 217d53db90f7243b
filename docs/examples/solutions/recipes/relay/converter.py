"""A relay: what is heard on one topic is published on another, in another unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.model import Bench, Pace
from autograder.kit.recipes.own_scenario import OwnScenario
from autograder.kit.rules import Rule

if TYPE_CHECKING:
    from autograder.kit.evidence import Part

PATIENCE = {Pace.FAST: 2.0, Pace.REAL_TIME: 6.0}
"""Seconds of wall time in which the last temperature must have come."""


def scenario(bench: Bench) -> None:
    """Publish temperatures that nobody can guess, and listen to what becomes of them."""
    here, heard_type = bench.reference.only("subscription")
    there, told_type = bench.reference.only("publisher")
    # Multiples of 5 on both sides of 0: in Fahrenheit they are whole numbers, in an order that repeats no message.
    bench.part("converting", celsius=[0, *(5 * n for n in bench.random.sample([-5, -4, -3, 2, 3, 5, 6], 5))])
    bench.listen(there, told_type)
    speaker = bench.speak(here, heard_type)
    bench.start()
    if bench.await_endpoint("subscription", here) and bench.await_endpoint("publisher", there):
        bench.release()
        bench.await_attention()
        for celsius in given(bench.seen()):
            speaker.send(data=float(celsius))
        if not bench.wait_until(
            lambda _: bench.heard(there) >= len(given(bench.seen())), PATIENCE[bench.pace]
        ):
            bench.note_whether_it_spins()
        bench.settle()
    bench.stop()


def given(seen: Part) -> list[int]:
    """The temperatures that the judge published."""
    return list(seen.inputs.get("celsius", ()))


def told(seen: Part) -> list[float]:
    """The temperatures that were published in answer."""
    return [round(float(event.data["fields"]["data"]), 3) for event in seen.of("message")]


conversion = Rule(given, told, lambda celsius: [degrees * 9 / 5 + 32 for degrees in celsius])
converter = Draft(
    "relay.converter",
    "A relay · The converter",
    "Publish each temperature that is heard, in degrees Fahrenheit.",
    subject := OwnScenario(scenario, "subscription", "publisher"),
)
converter.asks(
    "listens", 1, "Subscribes to the right topic, with the right type", subject.has("subscription")
)
converter.asks("speaks", 1, "Publishes on the right topic, with the right type", subject.has("publisher"))
converter.criterion("fahrenheit", 8, "Publishes each temperature in Fahrenheit, in order")(conversion.finding)
converter.knows(
    "offset_forgotten",
    conversion.taken_for(lambda celsius: [degrees * 9 / 5 for degrees in celsius]),
    "Your node publishes 0 for 0 °C, which is 32 °F.",
    "Add 32 after the multiplication: celsius * 9 / 5 + 32.",
    certain=True,
)
converter.knows(
    "offset_multiplied",
    conversion.taken_for(lambda celsius: [(degrees + 32) * 9 / 5 for degrees in celsius]),
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
