"""A small robot in the plane, drawn live below a cell, that anybody can drive over ordinary topics."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.notebook.robot.starting import LiveRobot


def start_robot() -> LiveRobot:
    """Start a small robot and show it, alive, below this cell.

    It is a node, ``/robot``, that subscribes to ``/cmd_vel``, publishes on ``/odom`` and ``/scan``, and offers the
    services ``/reset`` and ``/lamp`` and the action ``/walk_to``. It stops where no command has come for a second. A
    second run of the cell starts it anew; it ends with ``.stop()`` or with the kernel. Its picture is kept up to date
    for half an hour; ``.show()`` shows it again.
    """
    # Imported by those notebooks alone that start it: it needs more types of messages than all others.
    from autograder.notebook.robot.starting import LiveRobot

    robot = LiveRobot()
    robot.show()
    return robot
