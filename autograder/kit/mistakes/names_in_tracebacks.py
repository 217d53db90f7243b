"""Finds the names that the student's code uses, in the line of code that a traceback quotes.

Advice on a card can then use these names: ``fut.result()`` if the program calls its future ``fut``. If the quoted line
does not show the name, the advice uses a general term.
"""

from __future__ import annotations

import re2

MARKS = r"\n(?:[ ~^]*\n)?"
"""Matches the text between a quoted line of code and Python's message: a line break, and possibly a line of ``^`` and
``~``.
"""
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
_RESULT = ".result()"


class Name(str):
    """A name for a template. In ``{owner:your future}``, the text after the colon is used if the name is empty."""

    __slots__ = ()

    def __format__(self, otherwise: str) -> str:
        return str(self) or otherwise


def is_a_library(file: str) -> bool:
    """Return True for a file of Python, ROS or an installed package, but False for a student's own package."""
    built = _BUILT.search(file)
    return _LIBRARY.search(file) is not None and (built is None or built["package"] in _ROS)


def own_line(traceback: str) -> str:
    """Return the innermost line of code in a traceback if it is the student's; otherwise an empty text."""
    frames = list(_FRAME_WITH_CODE.finditer(traceback))
    return "" if not frames or is_a_library(frames[-1]["file"]) else str(frames[-1]["code"])


def names(traceback: str) -> dict[str, Name]:
    """Return the names from a traceback that templates can use: ``owner`` and ``future``; each is empty if unknown.

    Suppose that ``fut.result().sum`` fails because ``sum`` does not exist. Then the owner is ``fut.result()``, and the
    future is ``fut``. If the future is itself a call, such as ``make().result()``, its name stays empty, because each
    call would return a different future.
    """
    owner = _owner(traceback)
    future = owner.removesuffix(_RESULT) if owner.endswith(_RESULT) else ""
    return {"owner": Name(owner), "future": Name("" if "(" in future else future)}


def _owner(traceback: str) -> str:
    """Return the expression before the missing attribute in the student's line; empty if there are several."""
    missed = _MISSED.search(traceback)
    if missed is None:
        return ""
    pattern = _OWNER.replace("{name}", missed["name"])
    found = {one["owner"] for one in re2.finditer(pattern, own_line(traceback))}
    return str(found.pop()) if len(found) == 1 else ""
