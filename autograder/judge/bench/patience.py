"""The time that a student's program has: the seconds that the machine had for it, not those of the wall.

A limit that is generous on a quiet machine is none where thirty processes wait for a processor: there, a program that
does all it should is late. So a second counts less while the machine is crowded. It is still a limit: no more than
``SLOWEST`` times as long is waited.
"""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

CROWDED = 4.0
"""Runnable threads for each processor that the limits bear by themselves."""
SLOWEST = 3.0
"""A second of patience lasts at most so many seconds."""
_LOOK_EVERY = 0.1
_LOAD = Path("/proc/loadavg")


class Patience:
    """A number of seconds, used up more slowly while the machine is crowded.

    Args:
        seconds: On a machine that is not.
        slowness: How long a second of patience lasts now, in seconds.
        now: A monotonic clock, in seconds.
    """

    def __init__(
        self,
        seconds: float,
        *,
        slowness: Callable[[], float] | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._seconds = seconds
        self.slowness, self._now = slowness or machine_slowness, now
        self.restart()

    def restart(self) -> None:
        """Begin anew."""
        self._used = 0.0
        self._at = self._looked = self._now()
        self._factor = 1.0

    @property
    def left(self) -> float:
        """The seconds of patience that are left; not above zero at the end."""
        now = self._now()
        if now - self._looked >= _LOOK_EVERY:
            self._factor = self.slowness()
            self._looked = now
        self._used += (now - self._at) / self._factor
        self._at = now
        return self._seconds - self._used


def machine_slowness() -> float:
    """The seconds that a second of patience lasts now."""
    return slowness(runnable_threads(), os.cpu_count() or 1)


def runnable_threads() -> int:
    """The threads that run or wait for a processor now; 0 where /proc/loadavg cannot be read (proc(5))."""
    try:
        return int(_LOAD.read_text().split()[3].partition("/")[0])
    except (OSError, ValueError, IndexError):
        return 0


def slowness(runnable: float, processors: int) -> float:
    """The seconds that a second of patience lasts.

    Args:
        runnable: Threads that run or could run if a processor were free.
        processors: How many there are.
    """
    return min(SLOWEST, max(1.0, runnable / (CROWDED * processors)))
