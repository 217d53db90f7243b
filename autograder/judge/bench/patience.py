"""Time limits for a student's program that get longer while the machine is busy.

A limit that is generous on an idle machine is too short if thirty processes wait for a processor, because even a
correct program would exceed it. So a second of the limit lasts longer while the machine is busy, up to ``SLOWEST``
seconds.
"""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

CROWDED = 4.0
"""The number of runnable threads per processor from which on time limits get longer."""
SLOWEST = 3.0
"""The maximum factor by which a busy machine makes a time limit longer."""
_LOOK_EVERY = 0.1
_LOAD = Path("/proc/loadavg")


class Patience:
    """A time limit that gets longer while the machine is busy.

    Args:
        seconds: The time limit in seconds, on an idle machine.
        slowness: Returns the factor by which the time limit is longer at the moment; 1.0 on an idle machine.
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
        """Start the time limit again from the beginning."""
        self._used = 0.0
        self._at = self._looked = self._now()
        self._factor = 1.0

    @property
    def left(self) -> float:
        """The time that is left, in seconds of an idle machine; zero or negative if the limit is reached."""
        now = self._now()
        if now - self._looked >= _LOOK_EVERY:
            self._factor = self.slowness()
            self._looked = now
        self._used += (now - self._at) / self._factor
        self._at = now
        return self._seconds - self._used


def machine_slowness() -> float:
    """Return the factor by which the present load of this machine lengthens time limits."""
    return slowness(runnable_threads(), os.cpu_count() or 1)


def runnable_threads() -> int:
    """Return how many threads run or wait for a processor now; 0 if /proc/loadavg cannot be read (proc(5))."""
    try:
        return int(_LOAD.read_text().split()[3].partition("/")[0])
    except (OSError, ValueError, IndexError):
        return 0


def slowness(runnable: float, processors: int) -> float:
    """Return the factor by which a load lengthens time limits.

    Args:
        runnable: The number of threads that run or wait for a processor.
        processors: The number of processors.
    """
    return min(SLOWEST, max(1.0, runnable / (CROWDED * processors)))
