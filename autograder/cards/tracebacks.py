"""Finds the last line of the student's own code in a traceback."""

from __future__ import annotations

from dataclasses import dataclass

import re2

TRACEBACK = "Traceback (most recent call last)"
_FRAME = re2.compile(r'^ +File "(?P<file>[^"]*)", line (?P<line>\d+)')
_LIBRARIES = ("/site-packages/", "/lib/python3", "/opt/ros/", "<frozen")
_BUILT = re2.compile(r"/install/(?:[^/.]+/)?lib/python3[^/]*/site-packages/")
"""Matches the folder into which a build installs a workspace's modules, which the student wrote."""
_CALLED_BY_ROS = "/rclpy/task.py"
"""The file of rclpy that calls callbacks. A student's line above it in a traceback only calls ``spin`` and is not the
cause of the error.
"""
_CANNOT_BE_READ = ("SyntaxError", "IndentationError", "TabError")
"""Errors that have no traceback, because Python cannot start the program."""
_SCRIPT = re2.compile(r"/lib/[^/]+/[^/.]+$")
"""Matches the generated file of an entry point, which ``ros2 run`` starts and the student did not write."""
_CALLED_WITH = "Invoked with: "
_FORM_OF_CALL = re2.compile(r"\d+\. \(")
"""Matches a line with one of the signatures that an error of pybind11 lists."""
_CELLS = ("/ipykernel_", "<ipython-input")


@dataclass(frozen=True)
class TracebackPlace:
    """The student's line in which a program failed.

    Attributes:
        where: The position, such as ``"Line 11 of your cell"``, or the line of a file.
        quote: The text of the line without indentation; empty if unknown.
        error: The exception, such as ``"AttributeError: 'Talker' object has no attribute 'nmae'"``.
    """

    where: str
    quote: str
    error: str


def last_error(detail: str) -> str:
    """Return the last line that is not empty. If the text is a traceback, this is the exception."""
    told = (line.strip() for line in reversed(detail.splitlines()) if not line.startswith(_CALLED_WITH))
    return next((line for line in told if line and not _FORM_OF_CALL.match(line)), "")


def place(detail: str) -> TracebackPlace | None:
    """Return the last line of the student's own code in the last traceback of a text.

    Return None if there is no such line, or if the line only calls ``spin``: the mistake is then in a callback.
    """
    lines = detail.splitlines()
    error = last_error(detail)
    starts = [number for number, line in enumerate(lines) if line.startswith(TRACEBACK)]
    if not starts and error.startswith(_CANNOT_BE_READ):
        starts = [0]
    if not starts or error.startswith(TRACEBACK):
        return None
    found: tuple[str, str, str] | None = None
    for number in range(starts[-1], len(lines)):
        frame = _FRAME.match(lines[number])
        if frame and _is_students(frame["file"]):
            after = lines[number + 1] if number + 1 < len(lines) else ""
            quote = after.strip() if after.startswith("    ") and not _FRAME.match(after) else ""
            found = (frame["file"], frame["line"], quote)
        elif frame and _CALLED_BY_ROS in frame["file"]:
            found = None
    if found is None:
        return None
    file, line, quote = found
    of = "your cell" if any(part in file for part in _CELLS) else file.rpartition("/")[2]
    return TracebackPlace(f"Line {line} of {of}", quote, error)


def _is_students(file: str) -> bool:
    of_a_library = any(part in file for part in _LIBRARIES) and not _BUILT.search(file)
    return not of_a_library and not _SCRIPT.search(file)
