"""Lab 1.4 on the robot: an action that docks, and that a client can cancel on its way."""

from autograder.kit.oracle.same_as_solution import Goal, SameAsSolution, To

EXERCISE = SameAsSolution(
    "lab_1_4_robot.cancel",
    "Lab 1.4, on the robot · A dock that can be canceled",
    "Serve dock: drive that far and send the distance that is left, or stop when a client cancels.",
    gives=lambda random: [
        To("/scan", {"ranges": [9.0] * 36}),
        Goal("/dock", {"x": random.choice((0.25, 0.5))}),
        Goal("/dock", {"x": 4.0}, cancel_after=2),
        Goal("/dock", {"x": random.choice((0.75, 1.0))}),
    ],
    tells={"/dock": ("status", "feedback.distance", "result.arrived"), "/cmd_vel": "linear.x"},
    roles=("action_server", "publisher", "subscription"),
).exercise(
    text={
        "as long as `left` is more than 0 and no cancel is requested": "dock",
        "Stop the robot.": "cmd_vel",
        "Say how the goal ended: canceled, or succeeded.": "dock",
        "with `cancel_callback=self.on_cancel`, too": "dock",
    },
    counts={
        "": "How long your node sleeps between two commands is free, and so is a look ahead, as in `Dock`."
    },
)
