"""Time limits for a student's program that stretch while the machine is busy.

A limit that is generous on a quiet machine is too short if thirty processes wait for a processor: then a right
program is late. So a second counts less while the machine is busy. It is still a limit: a wait lasts at most
``SLOWEST`` times as long.
"""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

CROWDED = 4.0
"""The number of runnable threads for each processor that needs no longer limits."""
SLOWEST = 3.0
"""The most seconds that a second of patience lasts."""
_LOOK_EVERY = 0.1
_LOAD = Path("/proc/loadavg")


class Patience:
    """A number of seconds that is used up more slowly while the machine is busy.

    Args:
        seconds: The time limit on an idle machine.
        slowness: Returns how long a second of patience lasts now, in seconds.
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
        """Begin again."""
        self._used = 0.0
        self._at = self._looked = self._now()
        self._factor = 1.0

    @property
    def left(self) -> float:
        """The remaining seconds of patience; zero or less at the end."""
        now = self._now()
        if now - self._looked >= _LOOK_EVERY:
            self._factor = self.slowness()
            self._looked = now
        self._used += (now - self._at) / self._factor
        self._at = now
        return self._seconds - self._used


def machine_slowness() -> float:
    """Return how long a second of patience lasts now, in seconds."""
    return slowness(runnable_threads(), os.cpu_count() or 1)


def runnable_threads() -> int:
    """Return how many threads run or wait for a processor now; 0 if /proc/loadavg cannot be read (proc(5))."""
    try:
        return int(_LOAD.read_text().split()[3].partition("/")[0])
    except (OSError, ValueError, IndexError):
        return 0


def slowness(runnable: float, processors: int) -> float:
    """Return how long a second of patience lasts, in seconds.

    Args:
        runnable: Threads that run or could run if a processor were free.
        processors: The number of processors.
    """
    return min(SLOWEST, max(1.0, runnable / (CROWDED * processors)))
