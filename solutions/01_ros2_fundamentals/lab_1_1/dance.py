"""Lab 1.1, a node from nothing: a robot that drives in a circle."""

from autograder.kit import Mission

EXERCISE = Mission(
    "lab_1_1.dance",
    "Lab 1.1 · The dance",
    "Tell the robot every half second to drive in a circle.",
    drives=("Drives in a circle", "velocity", 6),
    rate=("Keeps the rate", "rate", 4),
    within=13.0,
).exercise(
    text={
        "publishes a `Twist` on `/cmd_vel` every 0.5 seconds": "rate",
        "with `linear.x` 0.3 and `angular.z` 1.0": "velocity",
        "a node `dancer`": "",
    },
)
