"""Lab 1.4 on the robot: an action that drives to a dock, and gives up where a wall is nearer."""

from itertools import pairwise
from random import Random

from autograder.kit import Goal, SameAsSolution, To, drawn_until, shuffled
from autograder.kit.oracle.drawings import scan

FREE, BLOCKED = ((0.5, 0.75), (0.25, 0.5), (0.25,)), (0.25, 0.5, 0.75)
"""The ways to a dock in meters, of which one each is free, and to those behind a wall. Each 0.25 m take real time."""
NEARER, FARTHER = (0.65, 0.85, 0.98), (1.0, 1.02, 6.0)
"""Where the wall ahead is, as a multiple of the way. A wall that is as far as the dock leaves the way free."""


def cases(random: Random) -> list[tuple[float, float]]:
    """Draw the way to each dock, and the wall ahead, in meters: neither the order nor one of them tells the other."""
    free = [random.choice(ways) for ways in FREE]
    pairs = [*zip(free, FARTHER, strict=True), *zip(shuffled(random, BLOCKED), NEARER, strict=True)]
    return shuffled(random, [(way, round(way * factor, 4)) for way, factor in pairs])


def is_telling(drawn: list[tuple[float, float]]) -> bool:
    """Return True if a wall is nearer than one before, and farther, and no distance of the wall tells a free way."""
    frees = [way <= ahead for way, ahead in drawn]
    blocked, free = (
        [ahead for way, ahead in drawn if (way <= ahead) is is_free] for is_free in (False, True)
    )
    return sum(one != other for one, other in pairwise(frees)) > 1 and max(blocked) > min(free)


def steps(random: Random) -> list[To | Goal]:
    """Return each scan, and after it a goal in the same direction. Walls all around are on the other side, but for one.

    So a node that looks at the nearest wall of all drives at least once.
    """
    drawn = drawn_until(lambda: cases(random), is_telling)
    pairs = [
        (
            scan(random, way, ahead, "near" if way <= ahead < way * FARTHER[-1] else "far"),
            Goal("/dock", {"x": way, "y": 0.7}),
        )
        for way, ahead in drawn
    ]
    return [step for pair in pairs for step in pair]


EXERCISE = SameAsSolution(
    "lab_1_4_robot.dock",
    "Lab 1.4, first half · An action that docks",
    "Serve dock: drive that far, send the distance that is left, and give up where a wall is nearer.",
    gives=steps,
    tells={
        "/dock": ("status", "feedback.distance", "result.arrived"),
        "/cmd_vel": ("linear.x", "angular.z"),
    },
    every=True,
    roles=("action_server", "publisher", "subscription"),
).exercise(
    text={
        "If the goal is farther than `self.ahead`, abort it, and send no command.": "dock cmd_vel",
        "as long as `left` is more than 0: `self.forward()` drives ahead for half a second": "cmd_vel",
        "Subtract them from `left`, and send `left` as the `distance` of the feedback.": "dock",
        "At the end publish a `Twist()`, which stops the robot, and say that the goal has succeeded.": "dock cmd_vel",
        "`arrived` is true only if the robot got there": "dock",
    },
    counts={
        "": "How long your node sleeps between two commands is free. Each way is a whole number of pieces."
    },
)
