"""The record of everything that the judge sees, in order, from any thread."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

from autograder.judge.bench.patience import Patience
from autograder.kit.evidence import REPORTS, Event, Part

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

MAX_EVENTS = 20_000
"""The most events of one part, so that a flood does not fill the memory."""
MAX_SAID = 1_000_000
"""The most characters of output and log of one part. If a subject says more, the last part is kept."""
MAX_TEXT = 50_000
"""The most characters of a text, and items of a list: far more than any message of the course, and just enough for a
stack.
"""
MAX_TEXTS = 20_000_000
"""The most characters of all texts of a part; of later texts only the beginning is kept."""
BEGINNING = 100
ITEM = 32
"""Characters that each item of a list counts: its entry and a number take as much memory."""
MAX_NAME = 300
"""The most characters of a name; DDS allows 255."""
_SPEECH = ("output", "log")


class Recorder:
    """An append-only list of events with a condition to wait on.

    Times are seconds since :meth:`begin`; ``began_at`` is that moment in seconds of Unix time. ``simulated_now`` is
    called at each event, so that a message has the simulated time at which it arrived.

    Attributes:
        take_in: Waits until everything that was sent to the judge so far is recorded.
    """

    def __init__(self, hurry: Callable[[], None] = lambda: None) -> None:
        """Prepare.

        Args:
            hurry: Called repeatedly during each wait; it may end the wait by raising an exception.
        """
        self._hurry = hurry
        self._changed = threading.Condition()
        self._events: list[Event] = []
        self._count = 0
        self._said = 0
        self._size = 0
        self._name = ""
        self._inputs: Mapping[str, Any] = {}
        self._start = time.monotonic()
        self._number = 0
        self.take_in: Callable[[], object] = lambda: None
        self.simulated_now: float | None = None
        self.began_at = time.time()

    def begin(self, name: str, inputs: Mapping[str, Any]) -> None:
        """Start a new part; forget the events of the one before."""
        with self._changed:
            self._events = []
            self._said = self._size = 0
            self._name = name
            self._inputs = dict(inputs)
            self._start = time.monotonic()
            self._number += 1
            self.simulated_now = None
            self.began_at = time.time()

    def in_this_part(self) -> Callable[..., None]:
        """Return :meth:`record` for the present part only: later events are dropped.

        For threads that may still be reading a run's output when the next run begins.
        """
        number = self._number

        def record(kind: str, name: str, **data: Any) -> None:
            self._record(kind, name, data, number)

        return record

    def end_of_this_part(self) -> Callable[..., None]:
        """Return a function that records the subject's end in the present part, after everything that it sent before.

        The arguments are the kind of end, such as ``"exited"``; a function that is called when that is recorded,
        before any waiting thread can see it; and data about the end.
        """
        number = self._number

        def end(name: str, known: Callable[[], object], **data: Any) -> None:
            moment = time.monotonic()
            self.take_in()
            with self._changed:
                self._record("subject", name, data, number, moment)
                known()

        return end

    def record(self, kind: str, name: str, **data: Any) -> None:
        """Record one event and wake every thread that waits for it."""
        self._record(kind, name, data, None)

    def _record(
        self, kind: str, name: str, data: Mapping[str, Any], part: int | None, moment: float | None = None
    ) -> None:
        kept, size = _kept(data, MAX_TEXT if self._size < MAX_TEXTS else BEGINNING)
        with self._changed:
            if part is not None and part != self._number:
                return
            self._count += 1
            self._size += size
            if kind in _SPEECH:
                self._said += size
                if self._said > MAX_SAID or len(self._events) >= MAX_EVENTS:
                    self._forget_old_words()
            if len(self._events) < MAX_EVENTS:
                t = (time.monotonic() if moment is None else moment) - self._start
                self._events.append(Event(t, kind, name[:MAX_NAME], kept, self.simulated_now))
            self._changed.notify_all()

    def _forget_old_words(self) -> None:
        """Drop the older half of the words, so that a talkative subject does not displace other events."""
        words = [event for event in self._events if _is_speech(event)]
        old = {id(event) for event in words[: len(words) // 2 + 1]}
        self._events = [event for event in self._events if id(event) not in old]
        self._said = sum(len(event.data["text"]) for event in self._events if _is_speech(event))

    @property
    def count(self) -> int:
        """Return the number of events so far, in all parts."""
        return self._count

    def part(self) -> Part:
        """Return the events of this part so far."""
        with self._changed:
            return Part(self._name, self._inputs, tuple(self._events))

    def wait(
        self,
        condition: Callable[[], bool],
        within: float,
        *,
        poll: float = 0.5,
        quiet: float | None = None,
        wall: bool = False,
    ) -> bool:
        """Wait until ``condition`` holds; it is checked again at every event.

        Args:
            condition: Called in the waiting thread without the recorder's lock.
            within: The limit in seconds of patience (:mod:`autograder.judge.bench.patience`).
            poll: Seconds after which it is checked again without an event. Queries of the graph have no event to wait
                for, so their callers give a few milliseconds.
            quiet: Give up earlier if nothing happened for this many seconds of patience.
            wall: True to count wall time instead: the wait sets the judge's own pace and is not a limit for the
                subject.

        Returns:
            True if the condition held in time.
        """
        slowness = (lambda: 1.0) if wall else None
        patience = Patience(within, slowness=slowness)
        silence = None if quiet is None else Patience(quiet, slowness=slowness)
        heard = self._count
        while True:
            self._hurry()
            seen = self._count
            if condition():
                return True
            if silence is not None and seen != heard:
                silence.restart()
                heard = seen
            left = patience.left if silence is None else min(patience.left, silence.left)
            if left <= 0:
                return False
            with self._changed:
                if self._count == seen:
                    self._changed.wait(min(left, poll))


def _is_speech(event: Event) -> bool:
    """True for the subject's own words; not for a runner's report about a build or a launch."""
    return event.kind in _SPEECH and not str(event.data.get("text", "")).startswith(REPORTS)


def _kept(data: Any, limit: int) -> tuple[Any, int]:
    """Return a copy of an observation, and the characters that it counts.

    It is cut to the size that a verdict can use, because a subject may send gigabytes.
    """
    if isinstance(data, str):
        # A lone surrogate, which JSON may contain, cannot be encoded: a verdict that quotes it could not be written.
        text = data if data.isascii() else data[:limit].encode("utf-8", "replace").decode() + data[limit:]
        return (text if len(text) <= limit else f"{text[:limit]}…"), min(len(text), limit)
    if isinstance(data, dict):
        pairs = {key: _kept(value, limit) for key, value in data.items()}
        return {key: kept for key, (kept, _) in pairs.items()}, sum(size for _, size in pairs.values())
    if isinstance(data, (list, tuple)):
        items = [_kept(item, limit) for item in data[:limit]]
        return [kept for kept, _ in items], sum(size for _, size in items) + ITEM * len(items)
    return data, 0
