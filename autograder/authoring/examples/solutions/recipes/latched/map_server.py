"""A latched topic: late subscribers receive a message that was published before they came."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.counterparts import Qos
from autograder.kit.draft import Draft
from autograder.kit.model import Bench, Finding
from autograder.kit.recipes.own_scenario import OwnScenario

if TYPE_CHECKING:
    from autograder.kit.evidence import Part

LATE = 1.0
"""Seconds of the subject's time after which the judge begins to listen."""
PATIENCE = 3.0
"""Seconds within which the earlier message must have come."""


def scenario(bench: Bench) -> None:
    """Let the subject publish, and begin to listen only then."""
    topic, type_name = bench.reference.only("publisher")
    bench.part("coming late")
    bench.start()
    if bench.await_endpoint("publisher", topic):
        bench.release()
        bench.run_time(LATE)
        bench.listen(topic, type_name, qos=Qos.LATCHED)
        bench.wait_until(
            lambda evidence: bool(evidence.main.of("mismatch") or messages(evidence.main)), PATIENCE
        )
        bench.settle()
        if not messages(bench.seen()):
            bench.note_whether_it_spins()
    bench.stop()


map_server = Draft(
    "latched.map_server",
    "A latched topic · The map server",
    "Publish the name of the map once, for late listeners too.",
    subject := OwnScenario(scenario, "publisher"),
)
map_server.asks("topic", 2, "Publishes on the right topic and type", subject.has("publisher"))


def messages(seen: Part) -> list[str]:
    """Return the texts that the late listener heard."""
    return [str(event.data["fields"]["data"]) for event in seen.of("message")]


@map_server.criterion("late", 5, "Is heard by who comes late")
def late(seen: Part, _: Part) -> Finding:
    """The late listener hears something."""
    heard = messages(seen)
    return Finding(bool(heard), "the message of before", f"“{heard[0]}”" if heard else "nothing")


@map_server.criterion("text", 3, "Says the name of the map")
def text(seen: Part, expected: Part) -> Finding:
    """The late listener hears the reference's text, and nothing else."""
    heard, wanted = messages(seen), messages(expected)
    seen_text = ", ".join(f"“{said}”" for said in heard[:3]) or "nothing"
    return Finding(
        set(heard) == set(wanted) and bool(heard), f"“{wanted[0]}”" if wanted else "a text", seen_text
    )


map_server.knows(
    "not_latched",
    lambda seen, _: any(event.data["policy"] == "durability" for event in seen.of("mismatch")),
    "Your publisher keeps no message: a subscription that is made later hears nothing.",
    "Give create_publisher QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL) in place of 10.",
    certain=True,
)
map_server.knows(
    "wrong_text",
    lambda seen, expected: bool(messages(seen)) and not text(seen, expected).passed,
    "A late subscription does not hear the name of the map.",
    "Publish the text kitchen, once. A depth of 1 keeps the last message alone.",
    certain=True,
)


EXERCISE = map_server.exercise()
