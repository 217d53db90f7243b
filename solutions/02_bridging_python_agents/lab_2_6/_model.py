"""Lab 2.6: a model that the judge plays, and what comes of its calls. Both follow from what they are told."""

import json
from collections.abc import Mapping
from random import Random
from typing import Any

import re2
from lab_2_5._model import field, lines

from autograder.kit import Text, Work

WISHES = (
    "Look into each room",
    "Find my glasses",
    "Say good night to the plants",
    "Bring the letters in",
    "Wake the others",
)
WALKS = {
    "walk": Work("succeeded", 0.3, [{"distance": 1.0}], {"arrived": True}),
    "blocked": Work("aborted", 0.3, [{"distance": 1.0}]),
    "refused": Work("rejected"),
    # The third feedback is the first that is no nearer.
    "stuck": Work("succeeded", 2.0, [{"distance": distance} for distance in (2.25, 1.5, 1.5, 1.5)]),
    "away": Work("succeeded", 2.0, [{"distance": distance} for distance in (2.25, 1.5, 1.75, 1.25)]),
    "long": Work("succeeded", 6.5, [{"distance": 5.0 - 0.25 * number} for number in range(12)]),
    # If it is left running, it tells nothing beside a newer walk.
    "quiet": Work("succeeded", 6.5),
    # Farther than any walk before it: a node that remembers the distance of another walk cancels it.
    "far": Work("succeeded", 1.5, [{"distance": distance} for distance in (5.0, 4.5, 4.0)]),
    # Nearer than any other walk, and each time by a centimeter or two.
    "slow": Work("succeeded", 1.5, [{"distance": distance} for distance in (0.75, 0.74, 0.72)]),
}
"""What comes of a walk. The last digit of its place says which: of ``x``, in centimeters."""
ANSWERS = {
    "yes": Work(takes=0.2, result={"reply": "yes"}),
    "slowly": Work(takes=1.4, result={"reply": "yes"}),
    "no": Work(takes=0.2, result={"reply": "no"}),
    "perhaps": Work(takes=0.2, result={"reply": "not yet, ask again and I may say yes"}),
    "promises": Work(takes=0.2, result={"reply": "yes, as soon as I am there"}),
    "late": Work(takes=3.2, result={"reply": "yes"}),
    "never": Work(takes=float("inf"), result={"reply": "yes"}),
    "shouts": Work(takes=0.2, result={"reply": "Yes"}),
}
"""What a person answers who is asked about a door. The last digit of the room says which."""


def order(random: Random, *kinds: str, takes: float = 0.05) -> Text:
    """Return an order. Its last word says to the model of the judge which calls it makes, and how long each takes."""
    return Text("/order", f"{random.choice(WISHES)}, {random.randrange(100, 1000)} {'-'.join(kinds)}-{takes}")


def reply(request: Mapping[str, Any]) -> Work:
    """Return the reply to a context, and how long it takes. Its order says which, for each line about a call."""
    order, *calls = lines(request)
    found = re2.search(r" ([a-z-]+)-([0-9]+\.[0-9]+)$", order)
    kinds, takes = (found[1].split("-"), float(found[2])) if found else (["done"], 0.05)
    kind = kinds[min(len(calls), len(kinds) - 1)]
    return Work(takes=takes, result={"reply": call(Random(f"{order} {len(calls)}"), kind)})


def call(random: Random, kind: str) -> str:
    """Return a call, or nearly one."""
    if kind in WALKS:
        x = random.randrange(3, 57) / 10 + [*WALKS].index(kind) / 100
        return json.dumps({"tool": "walk_to", "x": round(x, 2), "y": random.randrange(30, 370) / 100})
    if kind in ANSWERS:
        return json.dumps({"tool": "door", "room": random.randrange(10, 50) * 10 + [*ANSWERS].index(kind)})
    others: dict[str, Any] = {
        "lamp": {"tool": "lamp", "on": random.choice((True, False))},
        "nan": {"tool": "walk_to", "x": float("nan"), "y": 1.0},
        "fly": {"tool": "fly", "height": random.randrange(2, 9)},
        "done": {"tool": "done"},
    }
    return json.dumps(others.get(kind, others["done"]))


def walk(goal: Mapping[str, Any]) -> Work:
    """Return what comes of a walk."""
    return _numbered(WALKS, f"{goal['x']:.2f}")


def answer(request: Mapping[str, Any]) -> Work:
    """Return what the person answers to a question about a room."""
    return _numbered(ANSWERS, room(request))


def room(fields: Mapping[str, Any]) -> str:
    """Return the number of the room in a text."""
    return "".join(filter(str.isdecimal, fields["context"]))


def told(fields: Mapping[str, Any]) -> str:
    """Return what a model is told: the order, and of each call the first words of what came of it."""
    order, *calls = lines(fields)
    return "; ".join([order, *map(_outcome, calls)])


def _numbered(works: Mapping[str, Work], number: str) -> Work:
    """Return the work of which the last digit of a number is the index; without a digit the first one."""
    last = number[-1:]
    return [*works.values()][min(int(last) if last.isdecimal() else 0, len(works) - 1)]


def _outcome(line: str) -> str:
    call, _, outcome = (part.strip() for part in line.partition("->"))
    return f"{call} -> {field(outcome) if ':' in outcome else outcome}".rstrip()
