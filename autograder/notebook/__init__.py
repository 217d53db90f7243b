"""The functions that a notebook of the course imports, such as ``start_ros``, ``spinning`` and ``check``.

Promises: nothing here is secret or decides a grade, because the judge is a separate process.
Names: ``start_ros``, ``start_robot``, ``check``, ``watch``, ``spinning``, ``spin_in_background``, ``draw_graph``
Imports: ``cards``, ``check_journal``, ``course``, ``dds_discovery``, ``known_errors``, ``messages``, ``own_lines``,
    ``packed_files``, ``robot``, ``safe_files``, ``standard_output``, ``verdict``, ``workspaces``.
Takes: the student's classes and functions, in the kernel.
Gives: running nodes, pictures, and cards below the cells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import autograder.notebook.program_magic  # noqa: F401  (defines the cell magic %%program)
from autograder.notebook.checking import judge_link
from autograder.notebook.checking.check import check
from autograder.notebook.checking.watch_mode import unwatch, watch
from autograder.notebook.nodes import ros_session
from autograder.notebook.nodes.background_nodes import spin_in_background, spinning
from autograder.notebook.nodes.ros_session import RosSession
from autograder.notebook.observing.graph_picture import draw_graph, watch_graph

if TYPE_CHECKING:
    from autograder.notebook.live_robot import LiveRobot

__all__ = [
    "RosSession",
    "check",
    "draw_graph",
    "spin_in_background",
    "spinning",
    "start_robot",
    "start_ros",
    "unwatch",
    "watch",
    "watch_graph",
]


def start_ros() -> RosSession:
    """Start ROS in this kernel, and the judge in the background. If ROS already runs, nothing changes."""
    judge_link.warm_up()
    return ros_session.start_ros()


def start_robot(*, stranger: bool = False) -> LiveRobot:
    """Start a small robot, and show it live below this cell.

    The robot is a node, ``/robot``, that subscribes to ``/cmd_vel``, publishes on ``/odom`` and ``/scan``, and offers
    the services ``/reset`` and ``/lamp`` and the action ``/walk_to``. It stops if no command arrives for a second.
    Running the cell again restarts the robot. ``.stop()`` or the end of the kernel ends it. The picture is kept up to
    date for half an hour; ``.show()`` shows a new picture.

    Args:
        stranger: True for a robot without a manual: each start draws what it is called, and the names of the topic,
            the action and the lamp's service that it obeys. It says how many corners of the rooms it has visited.
    """
    # Import this here: it imports many message types, which only notebooks with the robot need.
    from autograder.notebook.live_robot import LiveRobot

    robot = LiveRobot(stranger=stranger)
    robot.show()
    return robot
