"""How long something may still take, asked again and again: until a moment, or for a number of seconds."""

from __future__ import annotations

import time
from collections.abc import Callable

Left = Callable[[], float]
"""The seconds that are left; none or fewer at the end."""
Patient = Callable[[float], Left]
"""What says how long a number of seconds lasts; it begins with the call."""


def until(deadline: float) -> Left:
    """Until a moment on the monotonic clock."""
    return lambda: deadline - time.monotonic()


def wall_time(seconds: float) -> Left:
    """For so many seconds of wall time."""
    return until(time.monotonic() + seconds)


def first_of(*lefts: Left) -> Left:
    """Until the first of several is up."""
    return lambda: min(left() for left in lefts)
