"""Finds the student's own line in a traceback, and what stands before a missing attribute in this line."""

from __future__ import annotations

import re2

_FRAME_WITH_CODE = re2.compile(r'(?m)^ {2}File "(?P<file>[^"]*)", line \d+.*\n {4,}(?P<code>\S.*)$')
"""Matches a frame of a traceback and the line of code quoted below it."""
_LIBRARY = re2.compile(r"/lib/python3(?:\.\d+)?/|/(?:site|dist)-packages/|^/opt/ros/|^<frozen")
_BUILT = re2.compile(
    r"/install/(?:[^/.]+/)?(?:local/)?lib/python3[^/]*/(?:site|dist)-packages/(?P<package>\w+)"
)
"""Matches the path of a package that colcon has installed: the student's package, or a package of ROS if ROS was built
from source.
"""
_ROS = ("rclpy", "launch", "launch_ros", "ros2cli", "ros2run")
_MISSED = re2.compile(r"AttributeError: .*(?:has no attribute|object attribute) '(?P<name>\w+)'")
_OWNER = r"(?:^|[^\w.)\]])(?P<owner>[A-Za-z_][\w.]*(?:(?:\(\)|\[[^\[\]]*\])[\w.]*)*)\.{name}\b"
"""Matches the expression before a dot and a given name, if it consists of names, dots, calls without arguments and
indexes.
"""


def is_a_library(file: str) -> bool:
    """Return True for a file of Python, ROS or an installed package, but False for a student's own package."""
    built = _BUILT.search(file)
    return _LIBRARY.search(file) is not None and (built is None or built["package"] in _ROS)


def own_line(traceback: str) -> str:
    """Return the innermost line of code in a traceback if it is the student's; otherwise an empty text."""
    frames = list(_FRAME_WITH_CODE.finditer(traceback))
    return "" if not frames or is_a_library(frames[-1]["file"]) else str(frames[-1]["code"])


def owner(traceback: str) -> str:
    """Return the expression before the missing attribute in the student's line; empty if there are several.

    If ``fut.result().sum`` fails because ``sum`` does not exist, this is ``fut.result()``.
    """
    missed = _MISSED.search(traceback)
    if missed is None:
        return ""
    pattern = _OWNER.replace("{name}", missed["name"])
    owners = {one["owner"] for one in re2.finditer(pattern, own_line(traceback))}
    return str(owners.pop()) if len(owners) == 1 else ""
