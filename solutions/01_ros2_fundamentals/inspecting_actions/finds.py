"""Inspecting actions: find out which node serves an action, and of which type it is. Its clients come first."""

from random import Random

from autograder.kit.draft import Draft
from autograder.kit.quests.quest import Quest
from autograder.kit.quests.robot import Robot

TYPES = ("small_robot_interfaces/action/WalkTo", "my_robot_interfaces/action/Fibonacci")
NAMES, WORDS = ("kit", "mia", "noa", "pip", "zoe"), ("dock", "go", "move", "roll", "travel")


def robot(n: int, name: str, action: str, types: tuple[str, str]) -> Robot:
    """Return a robot beside a client of its action, and beside a lift with an action of the other type."""
    nodes = {
        f"/boss{n}": {"subscribes": {action: types[0]}},
        f"/{name}": {"publishes": {action: types[0]}},
        f"/lift{n}": {"publishes": {f"/lift{n}/move": types[1]}, "subscribes": {action: types[0]}},
    }
    return Robot(asked=(action,), answer={"node": f"/{name}", "type": types[0]}, nodes=nodes)


def robots(random: Random) -> dict[str, Robot]:
    """Draw three robots that share no name. The name of an action does not tell which node serves it."""
    drawn = zip(random.sample(NAMES, 3), random.sample(WORDS, 3), (TYPES, TYPES[::-1], TYPES), strict=True)
    return {f"robot {n}": robot(n, name, f"/{word}", types) for n, (name, word, types) in enumerate(drawn, 1)}


quest = Quest(robots)
finds = Draft(
    "inspecting_actions.finds", "Inspecting actions · Who serves it", "Find who serves an action.", quest
)
finds.asks("node", "Finds the node that serves the action", quest.finds("node"))
finds.asks("type", "Finds the type of the action", quest.finds("type"))
EXERCISE = finds.exercise(
    arguments="the full name of an action",
    sample_arguments=("/nothing",),
    text={"`node`, the name of the node that serves it": "node", "`type`, its type": "type"},
    counts={"": "You may print the dictionary instead."},
)
