"""Tools: a node that reads orders, asks a service, and sends goals to an action; the judge plays all three."""

from random import Random
from typing import Any

from autograder.kit import Text, ToolUser, Work, mixed, shuffled

OPEN, LOCKED = {"success": True}, {"success": False, "message": "locked"}
LOST = Work("aborted", feedback=[{"distance": 1.0}], result={"x": 2.0})

WORDS = ("refused", "locked", "done", "lost")


def said(fields: dict[str, Any]) -> str:
    """Return the word that a text begins with, or the text."""
    text = str(fields["data"])
    return next((word for word in WORDS if text.startswith(word)), text)


def orders(random: Random) -> list[Text]:
    """Return orders in drawn order, of which two are none."""
    places = [
        {"x": round(random.uniform(0.5, 5.5), 2), "y": round(random.uniform(0.5, 3.5), 2)} for _ in range(7)
    ]
    return [Text("/order", order) for order in shuffled(random, [*places, "go to the door", {"x": "two"}])]


EXERCISE = ToolUser(
    "tools.courier",
    "Tools · The courier",
    "Have the door opened, and walk.",
    gives=orders,
    tells={"/said": {"first word": said}},
    asks={"/door": "data"},
    does={"/walk_to": ("x", "y")},
    serves={
        "/door": lambda random: mixed(
            random, [*[OPEN] * 5, LOCKED, LOCKED], lambda answer: answer["success"]
        ),
        "/walk_to": lambda random: mixed(
            random, [*[Work(takes=0.4)] * 3, *[LOST] * 2], lambda work: work.status
        ),
    },
    every=True,
    roles=("publisher", "subscription", "client", "action_client"),
).exercise(
    text={
        "A text that is not an order sends nothing": "door walk_to said",
        "The courier has the door opened": "door",
        "It walks only if the answer has `success`": "walk_to",
        "begins with `done`": "said",
    }
)
