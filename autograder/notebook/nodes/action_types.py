"""Makes rclpy check the type of an action server or client, as it checks the types of topics and services.

rclpy 7.1.5 passes the type of any message, service or part of an action to its compiled code, which takes it for the
type of an action and ends the process (``rclpy/action/server.py`` and ``client.py`` only call
``check_for_type_support``). In a notebook, the kernel would end.
"""

from __future__ import annotations

from typing import Any

from rclpy.action import client, server
from rclpy.type_support import check_for_type_support


def check_is_action_type(action_type: Any) -> None:
    """Do nothing if rclpy can make an action server or client of a type.

    Raises:
        AttributeError: The argument is not a type of ROS.
        TypeError: The argument is another type of ROS, a part of an action, or an object.
    """
    check_for_type_support(action_type)
    if not hasattr(action_type, "Impl"):
        name = getattr(action_type, "__name__", repr(action_type)).replace("_", ".")
        raise TypeError(
            f"rclpy needs the type of an action here, such as Fibonacci, and {name} is not an action"
        )


def check_from_now_on() -> None:
    """Have rclpy check the type of each action server and client, also of subclasses, before it makes one."""
    for module in (client, server):
        vars(module)["check_for_type_support"] = check_is_action_type
