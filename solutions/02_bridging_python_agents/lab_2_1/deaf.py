"""Lab 2.1, who is deaf: of the nodes that subscribe to a topic, one asks for more than its publisher offers."""

from random import Random

from autograder.kit import Draft, Qos, Quest, Robot, Searches

NAMES, KIND = ("arm", "base", "camera", "display", "gripper", "map", "planner"), "sensor_msgs/msg/LaserScan"
CASES = (
    ([Qos.SENSOR], [Qos.SENSOR, Qos.SENSOR], Qos.DEFAULT),
    ([Qos.DEFAULT], [Qos.DEFAULT, Qos.SENSOR], Qos.LATCHED),
    ([*[Qos.DEFAULT] * 4, Qos.SENSOR], [Qos.SENSOR], Qos.DEFAULT),
    ([Qos.SENSOR, *[Qos.DEFAULT] * 4], [Qos.SENSOR], Qos.DEFAULT),
    ([*[Qos.LATCHED] * 4, Qos.DEFAULT], [Qos.SENSOR], Qos.LATCHED),
)
"""The QoS of the publishers, of those who hear them, and of the one who is deaf to one of the publishers.

The graph lists publishers in any order. So a program that looks at one of them alone finds the right one of five, by
chance, once in 125 checks.
"""


def robots(random: Random) -> dict[str, Robot]:
    """Draw a robot for each case."""
    return {f"robot {number}": robot(random, number, *case) for number, case in enumerate(CASES, 1)}


def robot(random: Random, number: int, talk: list[Qos], hear: list[Qos], deaf: Qos) -> Robot:
    """Draw a robot: its publishers first, then its subscribers in any order."""
    topic, names = f"/laser{number}/scan", [f"/{name}{number}" for name in random.sample(NAMES, len(NAMES))]
    publishers = [
        (name, {"publishes": {topic: KIND}, "qos": qos}) for name, qos in zip(names, talk, strict=False)
    ]
    rest = names[len(talk) :]
    subscribers = [
        (name, {"subscribes": {topic: KIND}, "qos": qos})
        for name, qos in zip(rest, [deaf, *hear], strict=False)
    ]
    nodes = dict(publishers + random.sample(subscribers, len(subscribers)))
    return Robot(asked=(topic,), answer={"node": rest[0]}, nodes=nodes)


def hears_well(seen: Searches, _: Searches) -> str:
    """Return a subscriber that was named and is not deaf; empty if there is none."""
    named = [(search.robot.nodes, name) for search in seen.values() for name in search.astray]
    return next((name for nodes, name in named if "subscribes" in nodes.get(name, {})), "")


NEXT_STEPS = {
    "gave_up": (
        "Go through each publisher with each subscriber. Pass the publisher's qos_profile first, then "
        "the subscriber's, to qos_check_compatible, which returns two values: the first is the one to "
        "compare with ERROR."
    ),
    "wrong_node": (
        "Return the node_name of the subscriber of the pair that does not fit, not the publisher's."
    ),
}
"""What the student should do now, by the key of the mistake."""

quest = Quest(robots, next_steps=NEXT_STEPS)
finds = Draft(
    "lab_2_1.deaf", "Lab 2.1 · Who is deaf", "Find the node that cannot hear a topic's publisher.", quest
)
finds.asks("node", "Finds the node that cannot hear", quest.finds("node"))
finds.knows(
    "hears_well",
    hears_well,
    "Your answer names {}, which subscribes to the topic, and hears its publishers.",
    "Pass the publisher's qos_profile first, then the subscriber's, to qos_check_compatible, and look for ERROR: only "
    "a subscriber that asks for more than is offered hears nothing. A different QoS alone is not an error.",
)
EXERCISE = finds.exercise(
    arguments="a topic",
    sample_arguments=("/nothing",),
    text={"look for a pair that does not fit, and return the subscriber's `node_name`": "node"},
)
