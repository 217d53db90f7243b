"""Inspecting topics: find out what any robot is called, and which topic it obeys."""

from random import Random

from autograder.kit.quests.quest import Quest
from autograder.kit.quests.robot import Robot

TWIST, OTHER = "geometry_msgs/msg/Twist", "geometry_msgs/msg/Accel"
NAMES, WORDS = ("kit", "mia", "noa", "pip", "zoe"), ("drive", "go", "move", "roll", "steer")


def robots(random: Random) -> dict[str, Robot]:
    """Draw three robots. Beside each are a lift, which obeys another type, and a joystick, which obeys nothing."""
    drawn = {}
    for n, name, word in zip("123", random.sample(NAMES, 3), random.sample(WORDS, 3), strict=True):
        obeys = f"/{name}/{word}"  # in the list of topics neither the first nor the last with a Twist
        lift, joystick = {f"/lift{n}/cmd_vel": OTHER}, {f"/joystick{n}/cmd_vel": TWIST}
        own = {"publishes": {f"/{name}/velocity": TWIST}, "subscribes": {obeys: TWIST}}
        nodes = {f"/lift{n}": {"subscribes": lift}, f"/joystick{n}": {"publishes": joystick}, f"/{name}": own}
        drawn[f"robot {n}"] = Robot(answer={"robot": f"/{name}", "topic": obeys}, nodes=nodes)
    return drawn


EXERCISE = Quest(robots).exercise(
    "inspecting_topics.obeys",
    "Inspecting topics · What it obeys",
    "Find a robot, and what it obeys.",
    finds={"robot": "Finds what the robot is called", "topic": "Finds the topic that it obeys"},
    text={"`robot`, the name of the node that obeys": "robot", "the topic to which it subscribes": "topic"},
)
