"""Timers for what a launch has to do later."""

from __future__ import annotations

import heapq
import itertools
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(order=True)
class Timer:
    """A function to call at a certain time, in seconds of the monotonic clock."""

    deadline: float
    number: int
    action: Callable[[], None] = field(compare=False)
    cancel_on_shutdown: bool = field(compare=False, default=True)
    canceled: bool = field(compare=False, default=False)

    def cancel(self) -> None:
        """Cancel the timer. If it has already fired, do nothing."""
        self.canceled = True


class Timers:
    """The timers of a launch, each of which fires once."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._heap: list[Timer] = []
        self._numbers = itertools.count()

    def after(self, seconds: float, action: Callable[[], None], *, cancel_on_shutdown: bool = True) -> Timer:
        """Call `action` after a number of seconds."""
        timer = Timer(self._clock() + seconds, next(self._numbers), action, cancel_on_shutdown)
        heapq.heappush(self._heap, timer)
        return timer

    def _drop_canceled(self) -> None:
        while self._heap and self._heap[0].canceled:
            heapq.heappop(self._heap)

    def seconds_left(self) -> float | None:
        """Return the seconds until the next timer fires; None if there is none."""
        self._drop_canceled()
        return max(0.0, self._heap[0].deadline - self._clock()) if self._heap else None

    def fire_due(self) -> None:
        """Call the functions whose time has come."""
        while self.seconds_left() == 0.0:
            heapq.heappop(self._heap).action()

    def cancel_for_shutdown(self) -> None:
        """Cancel the timers that need not delay the end of a launch."""
        for timer in self._heap:
            timer.canceled = timer.canceled or timer.cancel_on_shutdown
