"""Inspecting topics: find out what any robot is called, and which topic it obeys.

In the list of topics, the one that the robot obeys is neither the first nor the last with a Twist.
"""

from random import Random

from autograder.kit.draft import Draft
from autograder.kit.quests.quest import Quest
from autograder.kit.quests.robot import Robot

TWIST = "geometry_msgs/msg/Twist"
NAMES, WORDS = ("kit", "mia", "noa", "pip", "zoe"), ("drive", "go", "move", "roll", "steer")


def robot(n: int, name: str, topic: str) -> Robot:
    """Return a robot beside a lift, which obeys another type, and a joystick, which obeys nothing."""
    nodes = {
        f"/lift{n}": {"subscribes": {f"/lift{n}/cmd_vel": "geometry_msgs/msg/Accel"}},
        f"/joystick{n}": {"publishes": {f"/joystick{n}/cmd_vel": TWIST}},
        name: {"publishes": {f"{name}/velocity": TWIST}, "subscribes": {topic: TWIST}},
    }
    return Robot(answer={"robot": name, "topic": topic}, nodes=nodes)


def robots(random: Random) -> dict[str, Robot]:
    """Draw three robots that share no name."""
    drawn = zip(random.sample(NAMES, 3), random.sample(WORDS, 3), strict=True)
    return {f"robot {n}": robot(n, f"/{name}", f"/{name}/{word}") for n, (name, word) in enumerate(drawn, 1)}


quest = Quest(robots)
obeys = Draft(
    "inspecting_topics.obeys", "Inspecting topics · What it obeys", "Find a robot, and what it obeys.", quest
)
obeys.asks("robot", "Finds what the robot is called", quest.finds("robot"))
obeys.asks("topic", "Finds the topic that it obeys", quest.finds("topic"))
EXERCISE = obeys.exercise(
    text={
        "`robot`, the name of the node that obeys": "robot",
        "`topic`, the topic to which it subscribes": "topic",
    },
    counts={"": "You may print the dictionary instead."},
)
