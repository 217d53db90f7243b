"""Lab 2.5: a model that the judge plays. What it replies follows from what it is told, and from nothing else."""

import json
from collections.abc import Mapping
from random import Random
from typing import Any

import re2

from autograder.kit import Work

WISHES = (
    "Come to the desk",
    "Light, please",
    "Go where it is warm",
    "Show me the door",
    "I need you in the hall",
)
_REPLIES = re2.compile(r"(good|sign|fenced|chat|nan|infinite|far|unknown|text)-(\d(?:\.\d+)?|inf)")
"""Matches the kind of a reply and its seconds. A subject may tell the model anything, also what no order says."""
STRIPPED = ":,.'\"`"


def order(random: Random, kind: str) -> str:
    """Return an order. Its last word says to the model of the judge which kind of replies it gets."""
    return f"{random.choice(WISHES)}, {random.randrange(100, 1000)} {kind}"


def good(random: Random) -> str:
    """Return a reply that is a right call."""
    if random.random() < 0.5:
        return json.dumps({"tool": "lamp", "on": random.choice((True, False))})
    return json.dumps(
        {"tool": "walk_to", "x": round(random.uniform(0.3, 5.7), 2), "y": round(random.uniform(0.3, 3.7), 2)}
    )


def bad(random: Random, kind: str) -> str:
    """Return a reply that is no right call."""
    x, y = round(random.uniform(0.3, 5.7), 2), round(random.uniform(0.3, 3.7), 2)
    call = good(random)
    replies: dict[str, Any] = {
        "sign": f"The sign says {call}, and I do not believe it.",
        "fenced": f"```json\n{call}\n```",
        "chat": f"Sure! I come at {random.randrange(1, 12)}.",
        "nan": {"tool": "walk_to", "x": float("nan"), "y": y},
        "infinite": {"tool": "walk_to", "x": x, "y": float("-inf")},
        "far": {"tool": "walk_to", "x": random.randrange(20, 90), "y": y},
        "unknown": {"tool": random.choice(("fly", "do", "destroy_node")), "x": x, "y": y},
        "text": {"tool": "lamp", "on": random.choice(("yes", "off"))},
    }
    reply = replies[kind]
    return reply if isinstance(reply, str) else json.dumps(reply)


def kind(*replies: str, takes: float = 0.05) -> str:
    """Return the kind of an order: one reply for each try, each after so many seconds."""
    return "-".join(f"{one}-{takes}" for one in replies)


def reply(request: Mapping[str, Any]) -> Work:
    """Return the reply to a context, and how long it takes. Its order says which, for each try."""
    order, *errors = lines(request)
    replies = _REPLIES.findall(order.split()[-1]) if order else []
    if not replies:
        return Work(takes=0.0, result={"reply": "What shall I do?"})
    one, seconds = replies[min(len(errors), len(replies) - 1)]
    random = Random(f"{order} {len(errors)}")
    return Work(takes=float(seconds), result={"reply": good(random) if one == "good" else bad(random, one)})


def told(fields: Mapping[str, Any]) -> str:
    """Return what a model is told: the order, and the field of each error."""
    order, *errors = lines(fields)
    return "; ".join([order, *(field(error) for error in errors)])


def lines(fields: Mapping[str, Any]) -> list[str]:
    """Return the lines of a context. A line may end with a new line, too, so an empty one does not count."""
    text = fields["context"].encode("utf-8", "replace").decode()
    return [line.strip() for line in text.split("\n") if line.strip()] or [""]


def field(error: str) -> str:
    """Return the first words of an error."""
    begins, _, rest = error.partition(":")
    return f"{begins}: {(rest.split() or [''])[0].strip(STRIPPED)}"
