"""Judges the offended dock: the dock of Lab 1.4, which also rejects a goal while it serves another one."""

from lab_1_4_robot import dock

from autograder.kit import Goal, SameAsSolution, To

FAR = To("/scan", {"ranges": [3.0] * 36})
# Sent at the same moment, and when the robot has driven for 3.5 s.
OTHERS = Goal("/dock", {"x": 0.25}, beside=Goal("/dock", {"x": 0.25}, after=7))

EXERCISE = SameAsSolution(
    "bugs_2._one_goal",
    "Bug hunt 2 · The dock",
    "Drive that far, give up where a wall is nearer, and serve one goal at a time.",
    gives=lambda random: [*dock.steps(random), FAR, Goal("/dock", {"x": 2.0}, beside=OTHERS)],
    tells={"/dock": ("status", "feedback.distance", "result.arrived"), "/cmd_vel": "linear.x"},
    every=True,
    roles=("action_server", "publisher", "subscription"),
).exercise()
