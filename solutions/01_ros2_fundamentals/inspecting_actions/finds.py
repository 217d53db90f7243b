"""Inspecting actions: find out which node serves an action, and of which type it is. Its clients come first."""

from random import Random

from autograder.kit.quests.quest import Quest
from autograder.kit.quests.robot import Robot

TYPES = ("small_robot_interfaces/action/WalkTo", "my_robot_interfaces/action/Fibonacci")
NAMES, WORDS = ("kit", "mia", "noa", "pip", "zoe"), ("dock", "go", "move", "roll", "travel")


def robots(random: Random) -> dict[str, Robot]:
    """Draw three robots, each with a client, between a crane and a lift with actions of another type.

    The graph lists nodes in the order in which they are made. So a subject that takes the first action that is served,
    or the last one, is wrong.
    """
    drawn = {}
    for n, name, word in zip("123", random.sample(NAMES, 3), random.sample(WORDS, 3), strict=True):
        action, other = {f"/{word}": TYPES[n == "2"]}, TYPES[n != "2"]
        nodes = {
            f"/boss{n}": {"subscribes": action},
            f"/crane{n}": {"publishes": {f"/crane{n}/move": other}},
            f"/{name}": {"publishes": action},
            f"/lift{n}": {"publishes": {f"/lift{n}/move": other}, "subscribes": action},
        }
        answer = {"node": f"/{name}", "type": action[f"/{word}"]}
        drawn[f"robot {n}"] = Robot(asked=(f"/{word}",), answer=answer, nodes=nodes)
    return drawn


EXERCISE = Quest(robots).exercise(
    "inspecting_actions.finds",
    "Inspecting actions · Who serves it",
    "Find who serves an action.",
    finds={"node": "Finds the node that serves the action", "type": "Finds the type of the action"},
    arguments="the full name of an action",
    sample_arguments=("/nothing",),
    text={"`node`, the name of the node that serves it": "node", "`type`, its type": "type"},
)
