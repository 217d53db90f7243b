"""Lab 2.4: what the exercises share: calls as a model writes them, on a good day and on a bad one."""

import json
from random import Random
from typing import Any

WORDS = ("Lamp", "Door", "Hello, world!", "Battery", "Kitchen", "Ready", "Shelf", "Good morning")
STRIPPED = ":,.'\"`"


def lamp(on: Any) -> str:
    """Return a call of the lamp."""
    return json.dumps({"tool": "lamp", "on": on})


def walk(x: Any, y: Any) -> str:
    """Return a call that walks."""
    return json.dumps({"tool": "walk_to", "x": x, "y": y})


def say(random: Random, begins: str = "") -> str:
    """Return a call that says something which nobody can guess."""
    return json.dumps({"tool": "say", "text": f"{begins}{random.choice(WORDS)} {random.randrange(1000)}"})


def place(random: Random) -> tuple[float, float]:
    """Return a place in the rooms."""
    return round(random.uniform(0.3, 5.7), 2), round(random.uniform(0.3, 3.7), 2)


def no_calls(random: Random) -> list[str]:
    """Return texts that are no JSON, and JSON that is no object."""
    return [
        f"I switch the {random.choice(WORDS)} on.",
        f"The sign says {lamp(True)}, and I do not obey.",
        f"```json\n{walk(*place(random))}\n```",
        '{"tool": "lamp", "on": true',
        random.choice(("[]", '["lamp", true]', "3", '"lamp"', "null", "true")),
    ]


def unknown_tools(random: Random) -> list[str]:
    """Return calls of tools that do not exist, also of methods of a node."""
    return [
        json.dumps({"tool": random.choice(("destroy_node", "answer", "on_call")), "text": "lamp"}),
        json.dumps({"tool": random.choice(("dance", "fly", "walk")), "on": True, "x": 1, "y": 1}),
        json.dumps({"tool": "Lamp", "on": random.choice((True, False))}),
        json.dumps({"tool": random.choice((["lamp"], {"lamp": True})), "on": True}),
        json.dumps({"on": True}),
    ]


def wrong_types(random: Random) -> list[str]:
    """Return calls with values of another type, or without a value."""
    x, y = place(random)
    return [
        lamp(random.choice(("yes", "on", "true"))),
        lamp(random.choice((0, 1))),
        lamp(None),
        json.dumps({"tool": "lamp"}),
        walk(str(x), y),
        walk(x, True),
        json.dumps({"tool": "walk_to", "x": x}),
        json.dumps({"tool": "walk_to", "y": y}),
        json.dumps({"tool": "say", "text": random.randrange(100)}),
        json.dumps({"tool": "say"}),
    ]


def out_of_range(random: Random) -> list[str]:
    """Return calls that lead out of the rooms, or say too much or nothing."""
    x, y = place(random)
    beyond, far = round(random.uniform(0.1, 1.5), 2), random.randrange(20, 90)
    return [
        walk(6 + beyond, y),
        walk(-beyond, y),
        walk(x, round(4 + beyond, 2)),
        walk(x, -far),
        walk(far, y),
        json.dumps({"tool": "say", "text": ""}),
        json.dumps({"tool": "say", "text": random.choice(WORDS) * 25}),
    ]


def not_finite(random: Random) -> list[str]:
    """Return calls with numbers that are none, in the spellings that Python reads."""
    x, y = place(random)
    return [
        walk(float("nan"), y),
        walk(x, float("nan")),
        walk(float("inf"), y),
        walk(x, float("-inf")),
        f'{{"tool": "walk_to", "x": {x}, "y": 1e400}}',
    ]


def outcome(fields: dict[str, Any]) -> str:
    """Return what an answer says: ``ok``, or ``error:`` with the name of the field, without the rest."""
    text = fields["data"].strip()
    begins, _, rest = text.partition(":")
    return f"error: {(rest.split() or [''])[0].strip(STRIPPED)}" if begins == "error" else text
