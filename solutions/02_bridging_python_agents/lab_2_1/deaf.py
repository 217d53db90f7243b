"""Lab 2.1, who is deaf: of the nodes that subscribe to a topic, one asks for more than its publisher offers."""

from random import Random

from autograder.kit.counterparts import Qos
from autograder.kit.draft import Draft
from autograder.kit.quests.quest import Quest
from autograder.kit.quests.robot import Robot

NAMES, KIND = ("arm", "base", "camera", "display", "gripper", "map", "planner"), "sensor_msgs/msg/LaserScan"


def robots(random: Random) -> dict[str, Robot]:
    """Draw three robots with a sensor, two nodes that hear it, and one that cannot."""
    drawn = {}
    for number in (1, 2, 3):
        topic, names = f"/laser{number}/scan", [f"/{name}{number}" for name in random.sample(NAMES, 4)]
        sensor, deaf = names[:2]
        ends = {"subscribes": {topic: KIND}}
        nodes = {sensor: {"publishes": {topic: KIND}, "qos": Qos.SENSOR}}
        nodes |= {
            name: ends | ({} if name == deaf else {"qos": Qos.SENSOR}) for name in random.sample(names[1:], 3)
        }
        drawn[f"robot {number}"] = Robot(asked=(topic,), answer={"node": deaf}, nodes=nodes)
    return drawn


quest = Quest(robots)
finds = Draft(
    "lab_2_1.deaf", "Lab 2.1 · Who is deaf", "Find the node that cannot hear a topic's publisher.", quest
)
finds.asks("node", "Finds the node that cannot hear", quest.finds("node"))
EXERCISE = finds.exercise(
    arguments="a topic",
    sample_arguments=("/nothing",),
    text={"look for a pair that does not fit, and return the subscriber's `node_name`": "node"},
)
