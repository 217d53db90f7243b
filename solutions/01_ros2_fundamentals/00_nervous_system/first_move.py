"""The first notebook: a command that drives the robot straight ahead, again and again."""

from __future__ import annotations

from autograder.kit import Mission

EXERCISE = Mission(
    "00_nervous_system.first_move",
    "The robotic nervous system · The first move",
    "Tell the robot every half second to drive straight ahead at 0.5 meters per second.",
    drives=("Drives straight ahead", "velocity", 6),
    rate=("Keeps the rate", "rate", 4),
    within=13.0,
).exercise(
    text={
        "Twice a second this driver makes a command": "rate",
        "set the speed straight ahead to `0.5`, and publish the command": "velocity",
    },
)
