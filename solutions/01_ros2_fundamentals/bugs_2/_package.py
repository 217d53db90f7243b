"""Judges the quiet morning: the launch file of Exercise 1.1, wherever in its package `ros2 launch` finds it."""

from dataclasses import replace

from exercise_1_1 import package

EXERCISE = replace(
    package.EXERCISE,
    id="bugs_2._package",
    # The ticket names no folder, and `ros2 launch` looks in all folders below share/my_robot_pkg.
    criteria=[one for one in package.EXERCISE.criteria if one.name == "launched"],
    text={},
    counts={},
)
