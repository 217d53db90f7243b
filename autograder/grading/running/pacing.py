"""How many notebooks run at once: found out while they run, not guessed from the number of cores.

A notebook mostly waits: for a timer, for a discovery, for a program to start. How many of them fill the machine depends
on what students wrote and on who else is at work. So one more is let in whenever the processors have time left and
memory is free, and one fewer when everybody only waits for everybody else. But never more than the machine has memory
for if each of them takes all that it may have: a submission that needs more is executed again, alone.
"""

from __future__ import annotations

import contextlib
import os
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import psutil

from autograder.boxes.limits import Limits

TICK = 0.5
"""Seconds between two looks at the machine."""
_IDLE_FOR_MORE = 0.06
_IDLE_FOR_MANY = 0.30
_IDLE_FOR_FEWER = 0.01
_STALLED_FOR_FEWER = 0.95
_TICKS_FOR_FEWER = 4
BOX_BYTES = Limits().beside_bytes + 150_000_000
"""Memory that one more notebook may take: its box, its judge and its worker."""
_RESERVE_BYTES = 1_000_000_000
_BUILD_BYTES = 500_000_000
"""Memory that a build takes; enough is kept for one build on each processor."""
_MOST_PER_CORE = 12
_PRESSURE = Path("/proc/pressure/cpu")


@dataclass(frozen=True)
class Load:
    """How busy the machine was since the last look.

    Attributes:
        idle: Share of the processors' time that nobody used, 0 to 1.
        stalled: Share of the time in which somebody waited for a processor, 0 to 1; None where the kernel does not
            say (PSI, ``Documentation/accounting/psi.rst``).
        free_bytes: Memory that can be had without swapping.
    """

    idle: float
    stalled: float | None
    free_bytes: int


class Machine:
    """Looks at the machine; each look tells what was since the one before."""

    def __init__(self) -> None:
        self._times = _times()
        self._stall = _stall_seconds()
        self._at = time.monotonic()

    def look(self) -> Load:
        """The load since the last call."""
        idle, total = _times()
        stall, now = _stall_seconds(), time.monotonic()
        passed = max(1e-6, total - self._times[1])
        stalled = None
        if stall is not None and self._stall is not None:
            stalled = (stall - self._stall) / max(1e-6, now - self._at)
        load = Load((idle - self._times[0]) / passed, stalled, psutil.virtual_memory().available)
        self._times, self._stall, self._at = (idle, total), stall, now
        return load


class Pace:
    """From one look to the next: how many may run at once.

    Args:
        cores: Processors.
        free_bytes: Memory that can be had before anybody runs.
    """

    def __init__(self, cores: int, free_bytes: int) -> None:
        self._cores = cores
        room = free_bytes - _RESERVE_BYTES - cores * _BUILD_BYTES
        self._most = max(1, min(cores * _MOST_PER_CORE, room // BOX_BYTES))
        self._crowded = 0

    @property
    def first(self) -> int:
        """With how many to begin."""
        return min(2 * self._cores, self._most)

    def next(self, allowed: int, load: Load, *, all_at_work: bool) -> int:
        """How many may run from now on.

        Args:
            allowed: How many may run so far.
            load: What the machine says.
            all_at_work: Whether so many do run, and others wait.
        """
        if load.free_bytes < _RESERVE_BYTES:
            return max(1, allowed - 1)
        if all_at_work and load.idle > _IDLE_FOR_MORE:
            self._crowded = 0
            room = (load.free_bytes - _RESERVE_BYTES) // BOX_BYTES
            step = 2 if load.idle > _IDLE_FOR_MANY else 1
            return min(allowed + min(step, room), self._most)
        crowded = load.idle < _IDLE_FOR_FEWER and (load.stalled is None or load.stalled > _STALLED_FOR_FEWER)
        self._crowded = self._crowded + 1 if crowded else 0
        if self._crowded >= _TICKS_FOR_FEWER:
            self._crowded = 0
            return max(min(self._cores, self._most), allowed - 1)
        return allowed


class Gate:
    """Lets only so many in at once.

    Args:
        allowed: How many.
    """

    def __init__(self, allowed: int) -> None:
        self.allowed = allowed
        self.inside = 0
        self._open = True
        self._changed = threading.Condition()

    def enter(self) -> bool:
        """Wait for a place; False when the gate was closed instead."""
        with self._changed:
            self._changed.wait_for(lambda: not self._open or self.inside < self.allowed)
            if self._open:
                self.inside += 1
            return self._open

    def leave(self) -> None:
        """Give the place back."""
        with self._changed:
            self.inside -= 1
            self._changed.notify()

    def allow(self, number: int) -> None:
        """Change how many may be inside; nobody is thrown out."""
        with self._changed:
            self.allowed = number
            self._changed.notify_all()

    def close(self) -> None:
        """Let nobody in any more, and wake who waits."""
        with self._changed:
            self._open = False
            self._changed.notify_all()


def _times() -> tuple[float, float]:
    """Idle and all CPU seconds since the machine was started."""
    times = psutil.cpu_times()
    return times.idle + getattr(times, "iowait", 0.0), sum(times[:8])  # guest times are within user times


def _stall_seconds() -> float | None:
    """For how long somebody waited for a processor since the machine was started."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        return int(_PRESSURE.read_text().split("total=")[1].split()[0]) / 1e6
    return None


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
