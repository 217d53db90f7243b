"""Exceptions that a program raises in order to say something, told from slips."""

from __future__ import annotations

import re2

SLIPS = ("AttributeError", "TypeError", "NameError", "UnboundLocalError", "KeyError", "IndexError")
"""Exceptions that nobody raises in order to say something."""
_FRAME = re2.compile(r'(?m)^ {2}File "(?P<file>[^"]*)", line \d+.*\n {4,}(?P<code>\S.*)$')
_LIBRARY = re2.compile(r"/(site|dist)-packages/|/lib/python3\.\d+/|/opt/ros/")


def meant(traceback: str) -> bool:
    """True if the innermost line of a traceback is one of the program's own that says ``raise`` or ``assert``."""
    frames = list(_FRAME.finditer(traceback))
    if not frames or _LIBRARY.search(frames[-1]["file"]):
        return False
    return re2.search(r"(?:^|[:;] *)(?:raise|assert)\b", frames[-1]["code"]) is not None
