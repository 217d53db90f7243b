"""The student's own names, as far as the line that a traceback quotes tells them.

Advice on a card says ``fut.result()`` where the program calls its future ``fut``. The last line of code in a traceback
is enough for that; where it does not tell the name, the advice has words of its own.
"""

from __future__ import annotations

import re2

FRAME_WITH_CODE = re2.compile(r'(?m)^ {2}File "(?P<file>[^"]*)", line \d+.*\n {4,}(?P<code>\S.*)$')
"""A frame of a traceback, with the line of code that is quoted below it."""
_LIBRARY = re2.compile(r"/python3(?:\.\d+)?/(?P<below>[^/]*)|/rclpy/|^<frozen")
_MISSED = re2.compile(r"AttributeError: .*(?:has no attribute|object attribute) '(?P<name>\w+)'")
_OWNER = r"(?:^|[^\w.)\]])(?P<owner>[A-Za-z_][\w.]*(?:(?:\(\)|\[[^\[\]]*\])[\w.]*)*)\.{name}\b"
"""What stands before a name and a dot: names and dots, calls without arguments, places in a list."""
_RESULT = ".result()"
_PACKAGES = re2.compile(r"/(?:site|dist)-packages/")
_BUILT = "/install/"
"""In the path of each file that a build of a student's workspace has installed."""


class Name(str):
    """A name for a template, which has other words where it is not known: ``{owner:your future}``."""

    __slots__ = ()

    def __format__(self, otherwise: str) -> str:
        return str(self) or otherwise


def is_a_library(file: str) -> bool:
    """True of a file of Python's own or of rclpy; a package that a student has built is none."""
    return any(found["below"] not in ("site-packages", "dist-packages") for found in _LIBRARY.finditer(file))


def _is_installed(file: str) -> bool:
    """True of a library, also one of another author: its names are none of the student's."""
    return is_a_library(file) or (_PACKAGES.search(file) is not None and _BUILT not in file)


def names(traceback: str) -> dict[str, Name]:
    """The names that a traceback tells, for a template: ``owner`` and ``future``, empty where they are not known.

    Of ``fut.result().sum``, where there is no ``sum``, the owner is ``fut.result()`` and the future ``fut``. A call is
    no name of a future: it would give another one each time.
    """
    owner = _owner(traceback)
    future = owner.removesuffix(_RESULT) if owner.endswith(_RESULT) else ""
    return {"owner": Name(owner), "future": Name("" if "(" in future else future)}


def _owner(traceback: str) -> str:
    """What the student's line has before the attribute that is missing; empty where several things may be meant."""
    missed, frames = _MISSED.search(traceback), list(FRAME_WITH_CODE.finditer(traceback))
    if missed is None or not frames or _is_installed(frames[-1]["file"]):
        return ""
    found = {
        one["owner"] for one in re2.finditer(_OWNER.replace("{name}", missed["name"]), frames[-1]["code"])
    }
    return str(found.pop()) if len(found) == 1 else ""
