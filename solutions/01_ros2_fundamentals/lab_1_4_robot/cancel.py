"""Lab 1.4 on the robot: an action that docks, and that a client can cancel on its way."""

from random import Random

from autograder.kit import Goal, SameAsSolution, To, drawn_until, shuffled
from autograder.kit.oracle.drawings import scan


def steps(random: Random) -> list[To | Goal]:
    """Return goals in drawn order, of which two are canceled. The last one is not, so it shows what a cancel leaves."""
    short = [Goal("/dock", {"x": random.choice(ways)}) for ways in ((0.25, 0.5), (0.5, 0.75))]
    ways = random.sample((2.5, 2.75, 3.0), 2)
    long = [Goal("/dock", {"x": x}, cancel_after=random.randint(1, 2)) for x in ways]
    goals = drawn_until(lambda: shuffled(random, [*short, *long]), lambda order: order[-1] in short)
    return [scan(random, 9.0, 9.0), *goals]


EXERCISE = SameAsSolution(
    "lab_1_4_robot.cancel",
    "Lab 1.4, first half · A dock that can be canceled",
    "Serve dock: drive that far and send the distance that is left, or stop when a client cancels.",
    gives=steps,
    tells={
        "/dock": ("status", "feedback.distance", "result.arrived"),
        "/cmd_vel": ("linear.x", "angular.z"),
    },
    every=("/cmd_vel",),
    roles=("action_server", "publisher", "subscription"),
).exercise(
    text={
        "as long as `left` is more than 0 and no cancel is requested": "dock cmd_vel",
        "Stop the robot.": "cmd_vel",
        "Say how the goal ended: canceled, or succeeded.": "dock",
        "Return the result as in `Dock`": "dock",
        "with `cancel_callback=self.on_cancel`, too": "dock",
    },
    counts={
        "": "How long your node sleeps between two commands is free, and so is a look ahead, as in `Dock`."
    },
)
