"""Where everything that the judge sees is written down, in order, from any thread."""

from __future__ import annotations

import copy
import threading
import time
from typing import TYPE_CHECKING, Any

from autograder.exercises.evidence import Event, Part

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

MAX_EVENTS = 20_000
"""Events that one part may hold: a flood is cut here instead of filling the memory."""


class Recorder:
    """An append-only list of events with a condition to wait on.

    Times are seconds since :meth:`begin`. ``simulated_now`` is asked at each event, so that a message carries
    the
    simulated time at which it arrived.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._events: list[Event] = []
        self._name = ""
        self._inputs: Mapping[str, Any] = {}
        self._start = time.monotonic()
        self.simulated_now: float | None = None

    def begin(self, name: str, inputs: Mapping[str, Any]) -> None:
        """Start a new part; forget the events of the one before."""
        with self._changed:
            self._events = []
            self._name = name
            self._inputs = dict(inputs)
            self._start = time.monotonic()
            self.simulated_now = None

    def record(self, kind: str, name: str, **data: Any) -> None:
        """Write down one event and wake everyone who waits for it."""
        with self._changed:
            if len(self._events) < MAX_EVENTS:
                t = time.monotonic() - self._start
                self._events.append(Event(t, kind, name, copy.deepcopy(data), self.simulated_now))
            self._changed.notify_all()

    def part(self) -> Part:
        """What has been seen so far in this part."""
        with self._changed:
            return Part(self._name, self._inputs, tuple(self._events))

    @property
    def idle(self) -> float:
        """Seconds of wall time since the last event (or since the part began)."""
        with self._changed:
            last = self._events[-1].t if self._events else 0.0
            return time.monotonic() - self._start - last

    def wait(self, condition: Callable[[], bool], within: float, *, poll: float = 0.5) -> bool:
        """Wait until ``condition`` holds; it is asked again at every event.

        Args:
            condition: Called in the waiting thread without the recorder's lock.
            within: Seconds of wall time at most.
            poll: Seconds after which it is asked again without an event. Graph queries have no event to wait
                for, so their callers give a few milliseconds.

        Returns:
            Whether the condition held in time.
        """
        deadline = time.monotonic() + within
        while True:
            seen = len(self._events)
            if condition():
                return True
            remaining = deadline - time.monotonic()
            if remaining <= 0:
                return False
            with self._changed:
                if len(self._events) == seen:
                    self._changed.wait(min(remaining, poll))
