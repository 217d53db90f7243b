"""Inspecting topics: find out what any robot is called, and which topic it obeys."""

from random import Random

from autograder.kit.quests.quest import Quest
from autograder.kit.quests.robot import Robot

TWIST, OTHER = "geometry_msgs/msg/Twist", "geometry_msgs/msg/Accel"
NAMES, WORDS = ("kit", "mia", "noa", "pip", "zoe"), ("drive", "go", "move", "roll", "steer")


def robots(random: Random) -> dict[str, Robot]:
    """Draw three robots. Each is between a lift and a crane, which obey another type; a joystick obeys nothing.

    The graph lists nodes in the order in which they are made. So a subject that takes the first topic with a
    subscription, or the last one, is wrong.
    """
    drawn = {}
    for n, name, word in zip("123", random.sample(NAMES, 3), random.sample(WORDS, 3), strict=True):
        obeys = f"/{name}/{word}"  # in the list of topics neither the first nor the last with a Twist
        nodes = {
            f"/lift{n}": {"subscribes": {f"/lift{n}/cmd_vel": OTHER}},
            f"/joystick{n}": {"publishes": {f"/joystick{n}/cmd_vel": TWIST}},
            f"/{name}": {"publishes": {f"/{name}/velocity": TWIST}, "subscribes": {obeys: TWIST}},
            f"/crane{n}": {"subscribes": {f"/crane{n}/cmd_vel": OTHER}},
        }
        drawn[f"robot {n}"] = Robot(answer={"robot": f"/{name}", "topic": obeys}, nodes=nodes)
    return drawn


EXERCISE = Quest(robots).exercise(
    "inspecting_topics.obeys",
    "Inspecting topics · What it obeys",
    "Find a robot, and what it obeys.",
    finds={"robot": "Finds what the robot is called", "topic": "Finds the topic that it obeys"},
    text={"`robot`, the name of the node that obeys": "robot", "the topic to which it subscribes": "topic"},
)
