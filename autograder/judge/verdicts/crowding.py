"""Measure how overloaded the machine was during a look in real time, so that its load fails no answer.

The load average (getloadavg(3)) would be the wrong measure: it still counts programs that ended before the look, and
hardly those that started with it.
"""

from __future__ import annotations

import math
import os
import threading
import time
from typing import TYPE_CHECKING, Self

from autograder.judge.bench.patience import SLOWEST, runnable_threads, slowness
from autograder.judge.bench.wire import JudgeFailed

if TYPE_CHECKING:
    from collections.abc import Callable

TOO_BUSY = (
    "The machine is too busy: so many programs want its processors that the judge cannot tell whether yours is slow "
    "or wrong. Close some, or wait a little, and check again."
)
SEEN_SO_FAR = "So far the judge saw this, and it may be due to the busy machine: “{}”"
"""Quotes the diagnosis of a look that may be wrong."""
ANSWER_WITHIN = 30.0
"""Wall time in seconds after which a check in a notebook ends without a verdict if the machine is crowded."""
_EVERY = 0.1
"""Seconds between two counts."""


class TooBusy(JudgeFailed):
    """The subject did not pass, and that may be because the machine was crowded."""


class OutOfTime(BaseException):
    """A check on an overloaded machine has used up its time. No ``except Exception`` may catch this."""


class Crowding:
    """Counts the threads that want a processor, from ``__enter__`` to ``__exit__``.

    Args:
        runnable: Returns how many there are now.
        processors: How many processors they share.
    """

    def __init__(
        self, runnable: Callable[[], int] = runnable_threads, processors: int = os.cpu_count() or 1
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
            if self._over.wait(_EVERY):
                return

    @property
    def too_busy(self) -> bool:
        """True if, on average, more threads wanted a processor than the judge's limits allow for."""
        mean = sum(self._counts) / len(self._counts)
        return slowness(mean, self._processors) >= SLOWEST


class Hurry:
    """Ends a check after :data:`ANSWER_WITHIN` seconds if the machine is so busy that it stretches the judge's limits.

    On any other machine a check takes as long as its exercise needs.

    Args:
        runnable: Returns how many threads want a processor now.
        processors: How many processors they share.
        now: A monotonic clock, in seconds.
        is_building: Returns True while a workspace is built: that has its own limit, so this time does not count.
    """

    def __init__(
        self,
        runnable: Callable[[], int] = runnable_threads,
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
        """Count, and end the check if its time is over; call it repeatedly while the judge waits.

        Raises:
            OutOfTime: At most once, because cleaning up after it waits, too.
        """
        now = self._now()
        if self._is_building():
            self._end = max(self._end, now + ANSWER_WITHIN)
        if now >= self._next_count:
            self._next_count = now + _EVERY
            self._sum += self._runnable()
            self._counts += 1
        if now > self._end and slowness(self._sum / self._counts, self._processors) > 1.0:
            self._end = math.inf
            raise OutOfTime
