"""What fork servers import before they fork: modules, the interfaces that come with ROS, the middleware."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

RCLPY = (
    "rclpy",
    "rclpy.action",
    "rclpy.callback_groups",
    "rclpy.executors",
    "rclpy.node",
    "rclpy.parameter",
    "rclpy.qos",
    "rclpy.task",
)
INTERFACES = (
    "action_msgs.msg",
    "action_msgs.srv",
    "geometry_msgs.msg",
    "nav_msgs.msg",
    "rcl_interfaces.msg",
    "rcl_interfaces.srv",
    "rosgraph_msgs.msg",
    "sensor_msgs.msg",
    "std_msgs.msg",
    "std_srvs.srv",
    "type_description_interfaces.msg",
)
_MIDDLEWARE = "librmw_fastrtps_cpp.so"


def preload(modules: Iterable[str]) -> None:
    """Import modules; what is not there is left to who needs it to miss."""
    for name in modules:
        with contextlib.suppress(Exception):
            importlib.import_module(name)


def preload_ros(interfaces: Iterable[str]) -> None:
    """Load the type support of interfaces, and what the first node and the first log line load.

    Args:
        interfaces: Modules with generated interfaces.
    """
    for name in interfaces:
        with contextlib.suppress(ImportError):
            for kind in list(vars(importlib.import_module(name)).values()):
                load = getattr(type(kind), "__import_type_support__", None)
                if load is not None:
                    load()
    with contextlib.suppress(OSError):
        # rclpy.init loads it, and finds it here already.
        ctypes.CDLL(_MIDDLEWARE)
    with contextlib.suppress(ImportError):
        # A first log line looks for its caller among the files of all modules (rclpy/impl/rcutils_logger.py, and
        # inspect.getmodule, which remembers them): 46 ms of processor time in each kernel, 8 where it was done here.
        importlib.import_module("rclpy.impl.rcutils_logger").CallerId()
