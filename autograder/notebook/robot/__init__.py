"""Simulate a small robot in the plane, drawn live below a cell and driven over ordinary topics."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.notebook.robot.live_robot import LiveRobot


def start_robot() -> LiveRobot:
    """Start a small robot, and show it live below this cell.

    The robot is a node, ``/robot``, that subscribes to ``/cmd_vel``, publishes on ``/odom`` and ``/scan``, and offers
    the services ``/reset`` and ``/lamp`` and the action ``/walk_to``. It stops if no command arrives for a second.
    Running the cell again restarts the robot. ``.stop()`` or the end of the kernel ends it. The picture is kept up to
    date for half an hour; ``.show()`` shows a new picture.
    """
    # Import this here: it imports many message types, which only notebooks with the robot need.
    from autograder.notebook.robot.live_robot import LiveRobot

    robot = LiveRobot()
    robot.show()
    return robot
