"""Simulated time: the judge publishes ``/clock`` and steps it, so that seconds cost milliseconds.

Each step is followed by questions to the subject's parameter service. The answers prove that its executor has called
the timers of the step, so the result does not depend on how busy the machine is. What does not follow the clock (a
``time.sleep``, a loop that spins only now and then) shows itself: it publishes while the clock stands still, or its
executor is slow to answer; the caller then looks again in real time.
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

STEP = 0.05
"""Simulated seconds a step: small beside any period of the course, so that a period is seen to this precision."""
FIRST = 100.0
"""Simulated seconds at the start. The jump to it distorts the first interval, which nobody counts."""
SLOW_STEP = 0.25
"""Seconds of wall time after which a step is suspicious: the subject sleeps, or the machine is overloaded."""
STANDSTILL = 0.06
"""Seconds of wall time for which the clock stands still before it is stepped."""


class SimulatedClock:
    """Steps the clock of one node.

    Attributes:
        doubtful: A step took so long, or somebody else moved the clock too, that what was seen must be confirmed in
            real time.
    """

    def __init__(self, wire: Wire, recorder: Recorder, node: NodeName) -> None:
        self.doubtful = False
        self._recorder = recorder
        self._now = FIRST
        self._clock = NodeClock(wire, recorder, node)

    def take_over(self) -> bool:
        """Make the node follow simulated time.

        Returns:
            Whether it said yes, hears the clock and its executor answers. A True does not yet prove that its
            timers follow: :meth:`stands_still` does.
        """
        if not (self._clock.follow(True) and self._clock.is_heard()):
            return False
        self._recorder.simulated_now = self._now
        return self._clock.show(self._now)

    def stands_still(self, silent: Callable[[], bool]) -> bool:
        """Hold the clock for a moment; whether the subject stays silent as long.

        Args:
            silent: Tells whether nothing was heard since it was made.
        """
        self._recorder.wait(lambda: not silent(), STANDSTILL)
        return silent()

    def run(self, seconds: float, until: Callable[[], bool]) -> bool:
        """Step through ``seconds`` of simulated time or until something holds.

        Returns:
            Whether the subject's executor answered after each step.
        """
        end = self._now + seconds
        while self._now < end and not until():
            began = time.monotonic()
            self._now = round(self._now + STEP, 6)
            self._recorder.simulated_now = self._now
            if not self._clock.show(self._now):
                self.doubtful = True
                return False
            # Where somebody else moves the clock, simulated time says nothing about the subject's rate.
            slow = time.monotonic() - began > SLOW_STEP
            self.doubtful = self.doubtful or slow or self._clock.is_rivalled()
        return True

    def close(self) -> None:
        """Stop publishing and asking."""
        self._recorder.simulated_now = None
        self._clock.close()
