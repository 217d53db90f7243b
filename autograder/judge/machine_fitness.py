"""Time limits that get longer while this machine is busy, and whether this machine is fit for judging at all.

A limit that is generous on an idle machine is too short if thirty processes wait for a processor, because even a
correct program would exceed it. So a second of a limit lasts longer while the machine is busy, up to ``SLOWEST``
seconds. If the machine is still busier, or loses messages, a check that the subject does not pass may end without a
verdict, so that no right answer fails because of the machine.
"""

from __future__ import annotations

import math
import os
import select
import socket
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from collections.abc import Callable


class JudgeFailed(RuntimeError):
    """There is no verdict, because the judge or its machine failed; the message says why."""


CROWDED = 4.0
"""The number of runnable threads per processor from which on time limits get longer."""
SLOWEST = 3.0
"""The maximum factor by which a busy machine makes a time limit longer."""
_LOOK_EVERY = 0.1
_LOADAVG = Path("/proc/loadavg")


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
    return slowness(_runnable_threads(), os.cpu_count() or 1)


def _runnable_threads() -> int:
    """Return how many threads run or wait for a processor now; 0 if /proc/loadavg cannot be read (proc(5))."""
    try:
        return int(_LOADAVG.read_text().split()[3].partition("/")[0])
    except (OSError, ValueError, IndexError):
        return 0


def slowness(runnable: float, processors: int) -> float:
    """Return the factor by which a load lengthens time limits.

    Args:
        runnable: The number of threads that run or wait for a processor.
    """
    return min(SLOWEST, max(1.0, runnable / (CROWDED * processors)))


TOO_BUSY = (
    "The machine is too busy: so many programs want its processors that the judge cannot tell whether your program is "
    "slow or wrong. Close some programs, or wait a little, and check again."
)
SEEN_SO_FAR = "So far the judge saw this, and it may be due to the busy machine: “{}”"
"""A sentence for the student, which quotes the diagnosis of a look that may be wrong because of the load."""
ANSWER_WITHIN = 30.0
"""Time limit in seconds of wall time for a check in a notebook on a crowded machine. At the limit, the check ends
without a verdict.
"""
_COUNT_EVERY = 0.1
"""Seconds between two counts of the threads."""


class TooBusy(JudgeFailed):
    """There is no verdict: the subject did not pass, but perhaps only because the machine was overloaded."""


class OutOfTime(BaseException):
    """A check on an overloaded machine took too long.

    This is a BaseException, so that ``except Exception`` does not catch it.
    """


class Crowding:
    """A context that counts, again and again, how many threads run or wait for a processor.

    The load average (getloadavg(3)) would be the wrong measure, because it is a mean over at least a minute: it still
    counts programs that ended before this context, and hardly counts those that started with this context.

    Args:
        runnable: Returns the number of threads that run or wait for a processor now.
        processors: The number of processors that they share.
    """

    def __init__(
        self, runnable: Callable[[], int] = _runnable_threads, processors: int = os.cpu_count() or 1
    ) -> None:
        self._runnable, self._processors = runnable, processors
        self._counts: list[int] = []
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._count, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    def _count(self) -> None:
        while True:
            self._counts.append(self._runnable())
            if self._over.wait(_COUNT_EVERY):
                return

    @property
    def too_busy(self) -> bool:
        """True if, on average, so many threads wanted a processor that the judge's time limits were too short."""
        mean = sum(self._counts) / len(self._counts)
        return slowness(mean, self._processors) >= SLOWEST


class Hurry:
    """Ends a check after :data:`ANSWER_WITHIN` seconds if the machine is so busy that the student would wait too long.

    A busy machine makes time limits longer, so a check could take minutes there. On a machine that is not busy, a check
    may take as long as its exercise needs.

    Args:
        runnable: Returns the number of threads that run or wait for a processor now.
        processors: The number of processors that they share.
        now: A monotonic clock, in seconds.
        is_building: Returns True while a workspace is built. A build has its own limit, so its time does not count.
    """

    def __init__(
        self,
        runnable: Callable[[], int] = _runnable_threads,
        processors: int = os.cpu_count() or 1,
        now: Callable[[], float] = time.monotonic,
        is_building: Callable[[], bool] = lambda: False,
    ) -> None:
        self._runnable, self._processors, self._now = runnable, processors, now
        self._is_building = is_building
        self._end = now() + ANSWER_WITHIN
        self._next_count = now()
        self._sum = self._counts = 0

    def __call__(self) -> None:
        """Count the threads, and end the check if its time is over. The judge calls this repeatedly while it waits.

        Raises:
            OutOfTime: The time is over. This is raised at most once, because the judge also waits while it cleans up.
        """
        now = self._now()
        if self._is_building():
            self._end = max(self._end, now + ANSWER_WITHIN)
        if now >= self._next_count:
            self._next_count = now + _COUNT_EVERY
            self._sum += self._runnable()
            self._counts += 1
        if now > self._end and slowness(self._sum / self._counts, self._processors) > 1.0:
            self._end = math.inf
            raise OutOfTime


NOT_DELIVERED = (
    "This machine delivers no messages at the moment, because other programs fill the memory of its sockets. So the "
    "judge cannot tell whether your node sent any. Close some programs, or wait a little, and check again."
)
_DATAGRAMS, _BYTES = 16, 4096
"""The number of datagrams to send, and the bytes in each. Together they are less than half of what a socket normally
holds, but more than a socket holds if other programs have used up the system's memory for sockets.
"""
_ARRIVES_WITHIN = 10.0
"""Time limit in seconds of wall time for a datagram to arrive. Only a busy processor can delay a datagram so long."""


class NotDelivered(JudgeFailed):
    """There is no verdict: the subject did not pass, but perhaps only because this machine lost messages."""


def delivers() -> bool:
    """Return True if datagrams that this process sends to itself arrive, and epoll reports them.

    The kernel limits the memory of all sockets of a machine, and the number of epoll watches of each user, sandboxes
    included. If either is used up, a node still starts without an error, but it receives little or nothing (udp(7),
    epoll(7)).
    """
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end, select.epoll() as watch:
            end.bind(("127.0.0.1", 0))
            watch.register(end, select.EPOLLIN)
            for _ in range(_DATAGRAMS):
                end.sendto(bytes(_BYTES), end.getsockname())
            for _ in range(_DATAGRAMS):
                if not watch.poll(_ARRIVES_WITHIN):
                    return False
                end.recv(_BYTES)
    except OSError:
        return False
    return True
