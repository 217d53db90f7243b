"""A service server: answers each call, with a number that goes up."""

from __future__ import annotations

from autograder.kit import Asks, Draft, Finding
from autograder.kit.recipes.servers import CALLS_AT_ONCE, ServerSeen

SINGLE = 3
"""Calls one by one; after them come several at once, and one more."""

door = Draft(
    "service_server.door",
    "A service server · The door",
    "Serve visit: count who comes.",
    # The requests one by one, then each of the other requests: a Trigger has no fields.
    asks := Asks(lambda _: [{}] * SINGLE, lambda _: {}),
)
door.asks("service", "Serves visit, with the right type", asks.serves, points=2)


def told(seen: ServerSeen) -> list[str]:
    """Return the messages of all answers, in the order of the calls."""
    return [str(answer["message"]) for _, answer in sorted(seen.answers.items())]


def due(number: int) -> list[str]:
    """Return the messages for this many visitors."""
    return [f"visitor {i}" for i in range(1, number + 1)]


@door.criterion("counts", "Counts who comes", points=4)
def counts(seen: ServerSeen, _: ServerSeen) -> Finding:
    """The calls one by one are answered with 1, 2, 3."""
    first = told(seen)[:SINGLE]
    return Finding(first == due(SINGLE), ", ".join(due(SINGLE)), ", ".join(first) or "no answer")


@door.criterion("together", "Answers several calls at once, each with a number of its own", points=2)
def together(seen: ServerSeen, _: ServerSeen) -> Finding:
    """All calls together have all numbers, the simultaneous ones in any order."""
    wanted, rest = due(SINGLE + CALLS_AT_ONCE + 1), told(seen)[SINGLE:]
    return Finding(
        sorted(told(seen)) == sorted(wanted), f"{wanted[-1]} is the last", ", ".join(rest) or "none"
    )


@door.criterion("success", "Says that all went well", points=2)
def success(seen: ServerSeen, _: ServerSeen) -> Finding:
    """The field success is true in each answer."""
    said = [answer["success"] for answer in seen.answers.values()]
    return Finding(bool(said) and all(said), "success is true", f"success was {said[:1] or 'never told'}")


door.knows(
    "counter_stuck",
    lambda seen, _: len(told(seen)) >= SINGLE and len(set(told(seen))) == 1 and bool(told(seen)[0]),
    "Every visitor is told the same: the number never changes.",
    "Count in an attribute, at the beginning of the method: self.visitors += 1.",
    certain=True,
)


EXERCISE = door.exercise()
