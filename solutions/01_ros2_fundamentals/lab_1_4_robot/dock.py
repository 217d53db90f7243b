"""Lab 1.4 on the robot: an action that drives to a dock, and gives up where a wall is nearer."""

from random import Random

from autograder.kit.oracle.same_as_solution import Goal, SameAsSolution, To

COURSE = (("far", (0.5, 0.75)), ("near", (1.0, 1.5)), ("far", (0.25, 0.5)))
AHEAD = {"far": (1.5, 3.0), "near": (0.2, 0.8)}


def steps(random: Random) -> list[To | Goal]:
    """Return each scan, and after it a goal in the same direction."""
    scans = [To("/scan", {"ranges": [random.uniform(*AHEAD[wall])] * 36}) for wall, _ in COURSE]
    goals = [Goal("/dock", {"x": random.choice(ways)}) for _, ways in COURSE]
    return [step for pair in zip(scans, goals, strict=True) for step in pair]


EXERCISE = SameAsSolution(
    "lab_1_4_robot.dock",
    "Lab 1.4, on the robot · An action that docks",
    "Serve dock: drive that far, send the distance that is left, and give up where a wall is nearer.",
    gives=steps,
    tells={"/dock": ("status", "feedback.distance", "result.arrived"), "/cmd_vel": "linear.x"},
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
    counts={"": "How long your node sleeps between two commands is free."},
)
