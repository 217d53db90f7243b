"""A moment of simulated time for a subject that lives in real time: its timers fire as they would later on.

What a program does by its timers in the next seconds is seen in milliseconds. Its clock goes on from where it is, and
is given back afterwards, so nothing that it has begun is lost. What does not follow a clock (a thread that sleeps) is
not seen so.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from autograder.judge.bench.node_clock import NodeClock

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.graph import NodeName
    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.bench.wire import Wire

STEP = 0.1
"""Simulated seconds a step. What a timer does more often than that is done in real time before anybody looks."""


class BorrowedTime:
    """Moves the clock of one node of the subject's."""

    def __init__(self, wire: Wire, recorder: Recorder, node: NodeName) -> None:
        self._clock = NodeClock(wire, recorder, node)

    def let_pass(self, seconds: float, until: Callable[[], bool]) -> bool:
        """Let simulated seconds pass, or fewer where ``until`` holds, and give the node its own time back.

        Returns:
            Whether the node went along: it took the clock, and answered after each step.
        """
        began = time.time()
        try:
            if not (self._clock.follow(True) and self._clock.is_heard() and self._clock.show(began)):
                return False
            steps = round(seconds / STEP)
            return all(until() or self._clock.show(began + STEP * step) for step in range(1, steps + 1))
        finally:
            self._clock.follow(False)

    def close(self) -> None:
        """Take away what was made for this."""
        self._clock.close()
