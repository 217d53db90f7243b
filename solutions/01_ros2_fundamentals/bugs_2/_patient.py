"""Judges the patient dock: the dock of Lab 1.4, whose first goal comes before the laser has seen anything."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lab_1_4_robot import dock

from autograder.kit import Goal, SameAsSolution

if TYPE_CHECKING:
    from autograder.kit.oracle.goal_sender import GoalSender

LATE = 4.0
"""How long the laser is silent after the goal: so many seconds of wall time, and then as many of the subject's time."""
FAR = [3.0] * 36
"""The ranges of the scan that comes then, in meters."""


@dataclass(frozen=True)
class GoalBeforeScan(Goal):
    """A goal that has to wait, because the first scan comes only later."""

    def play(self, sender: GoalSender) -> bool:
        """Send the goal, later a scan, and wait for the end of the goal. Return False if it does not end."""
        bench = sender.bench
        laser = bench.speak("/scan", "sensor_msgs/msg/LaserScan")
        number = sender.send(**self.fields)
        bench.wait_until(lambda _: sender[number].over, LATE)
        bench.run_time(LATE, until=lambda: sender[number].over)
        laser.send(ranges=FAR)
        return sender.finish(number)


EXERCISE = SameAsSolution(
    "bugs_2._patient",
    "Bug hunt 2 · The dock",
    "Wait for the laser, drive that far, give up where a wall is nearer, and serve any number of goals.",
    gives=lambda random: [GoalBeforeScan("/dock", {"x": 0.5}), *dock.steps(random)],
    tells={"/dock": ("status", "feedback.distance", "result.arrived"), "/cmd_vel": "linear.x"},
    every=True,
    roles=("action_server", "publisher", "subscription"),
).exercise()
