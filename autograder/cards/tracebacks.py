"""The line of the student's that a traceback is about."""

from __future__ import annotations

from dataclasses import dataclass

import re2

TRACEBACK = "Traceback (most recent call last)"
_FRAME = re2.compile(r'^ +File "(?P<file>[^"]*)", line (?P<line>\d+)')
_LIBRARIES = ("/site-packages/", "/lib/python3", "/opt/ros/", "<frozen")
_BUILT = re2.compile(r"/install/(?:[^/.]+/)?lib/python3[^/]*/site-packages/")
"""The folder into which a build installs the modules of a workspace: they are the student's own."""
_CALLED_BY_ROS = "/rclpy/task.py"
"""The file of rclpy that is below a line that spins, where a callback went wrong and not that line."""
_CANNOT_BE_READ = ("SyntaxError", "IndentationError", "TabError")
"""Errors that Python tells without a traceback, as nothing of the program has run."""
_SCRIPT = re2.compile(r"/lib/[^/]+/[^/.]+$")
"""The file that a build makes of an entry point, which ``ros2 run`` starts: nobody wrote its lines."""
_CALLED_WITH = "Invoked with: "
_FORM_OF_CALL = re2.compile(r"\d+\. \(")
"""The last lines of an error of pybind11: what was called with, and above that the forms that it has."""
_CELLS = ("/ipykernel_", "<ipython-input")


@dataclass(frozen=True)
class Place:
    """The place where a program went wrong.

    Attributes:
        where: ``"Line 11 of your cell"``, or of a file.
        quote: That line as it is there, without its indentation; empty where it is not known.
        error: What was raised, such as ``"AttributeError: 'Talker' object has no attribute 'nmae'"``.
    """

    where: str
    quote: str
    error: str


def last_error(detail: str) -> str:
    """The last line of a text that is not empty: at the end of a traceback, what was raised."""
    told = (line.strip() for line in reversed(detail.splitlines()) if not line.startswith(_CALLED_WITH))
    return next((line for line in told if line and not _FORM_OF_CALL.match(line)), "")


def place(detail: str) -> Place | None:
    """The last line of the student's in the last traceback of a text.

    None where there is none, and where that line only spins: the mistake is in what it calls back.
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
    return Place(f"Line {line} of {of}", quote, error)


def _is_students(file: str) -> bool:
    of_a_library = any(part in file for part in _LIBRARIES) and not _BUILT.search(file)
    return not of_a_library and not _SCRIPT.search(file)
