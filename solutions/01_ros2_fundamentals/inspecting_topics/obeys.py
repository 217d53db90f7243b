"""Inspecting topics: find out what any robot is called, and which topic it obeys."""

from random import Random
from typing import Any

from autograder.kit import Quest, Robot, drawn_until, shuffled

TWIST, ANOTHER, BEGINS_ALIKE = (f"geometry_msgs/msg/{name}" for name in ("Twist", "Accel", "TwistStamped"))
NAMES = (
    *("ada", "ben", "cleo", "dan", "eva", "finn", "gil", "hana", "ivo", "jan"),
    *("kit", "lea", "mia", "noa", "oda", "pip", "rosa", "sam", "tom", "zoe"),
)
WORDS, TEMPTING = ("drive", "go", "move", "push", "roll", "speed", "steer", "turn", "velocity"), "cmd_vel"
"""The words for topics: which node a topic belongs to, and whether it obeys it, only the graph tells. The usual word is
that of a topic of another type.
"""
FIRST, SECOND, LATE, NONE = "robot 1", "robot 2", "a robot that comes late", "no robot obeys"


def robot(random: Random, names: list[str], kind: str) -> Robot:
    """Draw a robot among others that obey another type, or that only publish a Twist.

    The graph lists nodes in the order in which they are made. So a subject that takes the first topic with a
    subscription, or the last one, is wrong.
    """
    own, *others = (f"/{names.pop()}" for _ in range(4))
    # A call about a node needs the node's own namespace: the node that is made first has one, and so has one robot.
    others[0] = f"/{random.choice(NAMES)}{others[0]}"
    own = f"/{random.choice(NAMES)}{own}" if kind == FIRST else own
    topics = map("/{}/{}".format, random.sample(NAMES, 8), random.sample(WORDS, 8))
    obeys = next(topics)
    heard = shuffled(random, [(next(topics), ANOTHER), (obeys, TWIST)])
    right: dict[str, Any] = {"publishes": {next(topics): TWIST}, "subscribes": dict(heard)}
    beside: list[dict[str, Any]] = [
        {"subscribes": {f"/{random.choice(NAMES)}/{TEMPTING}": ANOTHER}},
        {"subscribes": {next(topics): BEGINS_ALIKE}, "publishes": {next(topics): TWIST}},
        {"subscribes": {next(topics): ANOTHER}, "publishes": {next(topics): TWIST}},
    ]
    # In one run, a node whose type begins alike comes first.
    order = drawn_until(
        lambda: shuffled(random, beside), lambda order: kind != FIRST or order[0] is beside[1]
    )
    nodes = list(zip(others, order, strict=True))
    nodes.insert(random.choice((1, 2)), (own, right))
    if kind == NONE:
        del right["subscribes"][obeys]
        return Robot(nodes=dict(nodes))
    late = (own, nodes[-1][0]) if kind == LATE else ()
    return Robot(answer={"robot": own, "topic": obeys}, nodes=dict(nodes), late=late)


def robots(random: Random) -> dict[str, Robot]:
    """Draw two robots that are there, one that comes late, and a place without one. Their order is drawn, too."""
    names = shuffled(random, NAMES)
    return {kind: robot(random, names, kind) for kind in shuffled(random, (FIRST, SECOND, LATE, NONE))}


EXERCISE = Quest(robots).exercise(
    "inspecting_topics.obeys",
    "Inspecting topics · What it obeys",
    "Find a robot, and what it obeys.",
    finds={"robot": "Finds what the robot is called", "topic": "Finds the topic that it obeys"},
    gives_up="Gives up if no node obeys",
    text={
        "`robot`, the name of the node that obeys": "robot",
        "the topic to which it subscribes": "topic",
        "It raises `TimeoutError` if there is no such node for `patience_sec` seconds.": "limit",
    },
)
