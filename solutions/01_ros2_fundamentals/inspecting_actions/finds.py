"""Inspecting actions: find out which node serves an action, and of which type it is. Its clients come first."""

from random import Random
from typing import Any

from autograder.kit import Quest, Robot, drawn_until, shuffled

TYPES = ("small_robot_interfaces/action/WalkTo", "my_robot_interfaces/action/Fibonacci")
NAMES = (
    *("ada", "ben", "cleo", "dan", "eva", "finn", "gil", "hana", "ivo", "jan"),
    *("kit", "lea", "mia", "noa", "oda", "pip", "rosa", "sam", "tom", "zoe"),
)
WORDS = ("climb", "dock", "go", "lift", "move", "roll", "seek", "travel", "turn", "wait")
LATE, NONE = "a robot that comes late", "no node serves it"


def robot(random: Random, names: list[str], kind: str, type_name: str) -> Robot:
    """Draw a robot with a client, between others with actions of drawn types whose names begin alike.

    The graph lists nodes in the order in which they are made. So a subject that takes the first action that is served,
    or the last one, is wrong.
    """
    own, client, one, other = (f"/{names.pop()}" for _ in range(4))
    (before, word, after), (second, third) = sorted((words := random.sample(WORDS, 5))[:3]), words[3:]
    asked = f"/{word}_{second}"
    shorter, longer = shuffled(random, (f"/{word}", f"{asked}_{third}"))
    action, another = {asked: type_name}, next(one for one in TYPES if one != type_name)
    # By mistake, a client has the wrong type, and is made before the server: only the server's own list is the answer.
    beside: dict[str, dict[str, Any]] = {
        client: {"subscribes": {asked: another}},
        one: {"publishes": {shorter: random.choice(TYPES)}},
        other: {
            "publishes": {longer: random.choice(TYPES), f"{other}{asked}": another},
            "subscribes": action,
        },
    }
    nodes = drawn_until(lambda: shuffled(random, list(beside.items())), lambda nodes: nodes[2][0] != client)
    if kind == NONE:
        return Robot(asked=(asked,), nodes=dict(nodes))
    # The list of a node is sorted: a subject that looks only at the first or last action of a node is wrong.
    serves = {f"/{before}": another, **action, f"/{after}": another}
    nodes.insert(2, (own, {"publishes": serves}))
    late = (own, nodes[-1][0]) if kind == LATE else ()
    return Robot(asked=(asked,), answer={"node": own, "type": type_name}, nodes=dict(nodes), late=late)


def robots(random: Random) -> dict[str, Robot]:
    """Draw two robots that are there, one that comes late, and a place without one. Their order is drawn, too."""
    names, (walks, counts) = shuffled(random, NAMES), TYPES
    kinds = shuffled(random, ("robot 1", "robot 2", LATE, NONE))
    # No type is right for all robots. A late server is the only one whose client is certainly known when it is found.
    # The list of a name's types is sorted, the client's type first: a subject that takes the first type is wrong.
    found = iter(shuffled(random, (counts, random.choice(TYPES))))
    return {
        kind: robot(random, names, kind, walks if kind in (LATE, NONE) else next(found)) for kind in kinds
    }


EXERCISE = Quest(robots).exercise(
    "inspecting_actions.finds",
    "Inspecting actions · Who serves it",
    "Find who serves an action.",
    finds={"node": "Finds the node that serves the action", "type": "Finds the type of the action"},
    gives_up="Gives up if no node serves it",
    arguments="the full name of an action",
    sample_arguments=("/nothing",),
    text={
        "`node`, the name of the node that serves it": "node",
        "`type`, its type": "type",
        "It raises `TimeoutError` if no node serves the action for `patience_sec` seconds.": "limit",
    },
)
