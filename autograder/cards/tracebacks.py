"""The line of the student's that a traceback is about."""

from __future__ import annotations

from dataclasses import dataclass

import re2

TRACEBACK = "Traceback (most recent call last)"
_FRAME = re2.compile(r'^ +File "(?P<file>[^"]*)", line (?P<line>\d+)')
_LIBRARIES = ("/site-packages/", "/lib/python3", "/opt/ros/", "<frozen")
_SCRIPT = re2.compile(r"/lib/[^/]+/[^/.]+$")
"""The file that a build makes of an entry point, which ``ros2 run`` starts: nobody wrote its lines."""
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


def place(detail: str) -> Place | None:
    """The last line of the student's in the last traceback of a text; None where there is none."""
    lines = detail.splitlines()
    starts = [number for number, line in enumerate(lines) if line.startswith(TRACEBACK)]
    if not starts:
        return None
    found: tuple[str, str, str] | None = None
    for number in range(starts[-1], len(lines)):
        frame = _FRAME.match(lines[number])
        if (
            frame
            and not any(part in frame["file"] for part in _LIBRARIES)
            and not _SCRIPT.search(frame["file"])
        ):
            after = lines[number + 1] if number + 1 < len(lines) else ""
            quote = after.strip() if after.startswith("    ") and not _FRAME.match(after) else ""
            found = (frame["file"], frame["line"], quote)
    error = next((line for line in reversed(lines) if line.strip()), "").strip()
    if found is None or error.startswith(TRACEBACK):
        return None
    file, line, quote = found
    of = "your cell" if any(part in file for part in _CELLS) else file.rpartition("/")[2]
    return Place(f"Line {line} of {of}", quote, error)
