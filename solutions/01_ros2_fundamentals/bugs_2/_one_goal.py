"""Judges the offended dock: the dock of Lab 1.4, which also rejects a goal while it serves another one."""

from lab_1_4_robot import dock

from autograder.kit.oracle.same_as_solution import Goal, SameAsSolution

EXERCISE = SameAsSolution(
    "bugs_2._one_goal",
    "Bug hunt 2 · The dock",
    "Drive that far, give up where a wall is nearer, and serve one goal at a time.",
    gives=lambda random: [*dock.steps(random), Goal("/dock", {"x": 0.75}, beside=Goal("/dock", {"x": 0.25}))],
    tells={"/dock": ("status", "feedback.distance", "result.arrived"), "/cmd_vel": "linear.x"},
    every=True,
    roles=("action_server", "publisher", "subscription"),
).exercise()
