"""The student's own names, as far as the quoted line in a traceback shows them.

Advice on a card says ``fut.result()`` if the program names its future ``fut``. The last line of code in a traceback
is enough for that; if it does not show the name, the advice uses a general term.
"""

from __future__ import annotations

import re2

MARKS = r"\n(?:[ ~^]*\n)?"
"""From a line of code to Python's message about it: perhaps with a line of marks below the code."""
_FRAME_WITH_CODE = re2.compile(r'(?m)^ {2}File "(?P<file>[^"]*)", line \d+.*\n {4,}(?P<code>\S.*)$')
"""A frame of a traceback, with the line of code that is quoted below it."""
_LIBRARY = re2.compile(r"/lib/python3(?:\.\d+)?/|/(?:site|dist)-packages/|^/opt/ros/|^<frozen")
_BUILT = re2.compile(
    r"/install/(?:[^/.]+/)?(?:local/)?lib/python3[^/]*/(?:site|dist)-packages/(?P<package>\w+)"
)
"""A package that a build has installed, such as a student's own; or ROS, if it was built from source."""
_ROS = ("rclpy", "launch", "launch_ros", "ros2cli", "ros2run")
_MISSED = re2.compile(r"AttributeError: .*(?:has no attribute|object attribute) '(?P<name>\w+)'")
_OWNER = r"(?:^|[^\w.)\]])(?P<owner>[A-Za-z_][\w.]*(?:(?:\(\)|\[[^\[\]]*\])[\w.]*)*)\.{name}\b"
"""The text before a dot and a name: names and dots, calls without arguments, indexes."""
_RESULT = ".result()"


class Name(str):
    """A name in a template, with another text if it is unknown: ``{owner:your future}``."""

    __slots__ = ()

    def __format__(self, otherwise: str) -> str:
        return str(self) or otherwise


def is_a_library(file: str) -> bool:
    """True for a file of Python, of ROS or of an installed package, but not of a student's own package."""
    built = _BUILT.search(file)
    return _LIBRARY.search(file) is not None and (built is None or built["package"] in _ROS)


def own_line(traceback: str) -> str:
    """The innermost line of code in a traceback, if it is the student's; empty otherwise."""
    frames = list(_FRAME_WITH_CODE.finditer(traceback))
    return "" if not frames or is_a_library(frames[-1]["file"]) else str(frames[-1]["code"])


def names(traceback: str) -> dict[str, Name]:
    """Return the names in a traceback for a template: ``owner`` and ``future``, empty if they are unknown.

    In ``fut.result().sum``, if ``sum`` does not exist, the owner is ``fut.result()`` and the future is ``fut``. A
    call is never the name of a future: it would return another one each time.
    """
    owner = _owner(traceback)
    future = owner.removesuffix(_RESULT) if owner.endswith(_RESULT) else ""
    return {"owner": Name(owner), "future": Name("" if "(" in future else future)}


def _owner(traceback: str) -> str:
    """Return what the student's line has before the missing attribute; empty if it is ambiguous."""
    missed = _MISSED.search(traceback)
    if missed is None:
        return ""
    pattern = _OWNER.replace("{name}", missed["name"])
    found = {one["owner"] for one in re2.finditer(pattern, own_line(traceback))}
    return str(found.pop()) if len(found) == 1 else ""
