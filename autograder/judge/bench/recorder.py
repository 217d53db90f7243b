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
"""Events that one part may hold: a flood is cut here instead of filling the memory."""
MAX_SAID = 1_000_000
"""Characters of output and log that one part holds. Of a subject that says more, the last is kept."""
MAX_TEXT = 50_000
"""Characters of one text, items of one list: no message of the course comes near, and a stack just fits."""
MAX_TEXTS = 20_000_000
"""Characters of all texts of a part; of what comes after these only the beginning is kept."""
BEGINNING = 100
ITEM = 32
"""Characters that an item of a list counts as: its place there and a number take as much memory."""
MAX_NAME = 300
"""Characters of a name; DDS allows 255."""
_SPEECH = ("output", "log")


class Recorder:
    """An append-only list of events with a condition to wait on.

    Times are seconds since :meth:`begin`; ``began_at`` is that moment in seconds of Unix time. ``simulated_now`` is
    asked at each event, so that a message carries the simulated time at which it arrived.

    Attributes:
        take_in: Waits until all that was sent to the judge by now is written down.
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
        """:meth:`record` for as long as the part lasts that goes on now: what comes later is dropped.

        For threads that may still be reading what a run has said when the next one begins.
        """
        number = self._number

        def record(kind: str, name: str, **data: Any) -> None:
            self._record(kind, name, data, number)

        return record

    def end_of_this_part(self) -> Callable[..., None]:
        """Writes down how the subject has just ended, in the part that goes on now, behind all that it sent before.

        Its arguments are the kind of end, such as ``"exited"``; what is called when that is written down, before
        anybody who waits can look; and what is known of the end.
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
        """Write down one event and wake everyone who waits for it."""
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
        """Drop the older half of what was said, so that who says much keeps nothing else from being seen."""
        words = [event for event in self._events if _is_speech(event)]
        old = {id(event) for event in words[: len(words) // 2 + 1]}
        self._events = [event for event in self._events if id(event) not in old]
        self._said = sum(len(event.data["text"]) for event in self._events if _is_speech(event))

    @property
    def count(self) -> int:
        """The number of events so far, in all parts."""
        return self._count

    def part(self) -> Part:
        """The events of this part so far."""
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
        """Wait until ``condition`` holds; it is asked again at every event.

        Args:
            condition: Called in the waiting thread without the recorder's lock.
            within: Seconds at most, as :mod:`autograder.judge.bench.patience` counts them.
            poll: Seconds after which it is asked again without an event. Graph queries have no event to wait
                for, so their callers give a few milliseconds.
            quiet: Give up earlier when nothing happened for so many seconds, counted likewise.
            wall: Count wall time instead: what is waited for sets the judge's own pace and is no limit.

        Returns:
            Whether the condition held in time.
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
    """True if it is something that a subject said; what a runner reports of a build or a launch is not."""
    return event.kind in _SPEECH and not str(event.data.get("text", "")).startswith(REPORTS)


def _kept(data: Any, limit: int) -> tuple[Any, int]:
    """A copy of what was seen, and how many characters of room it takes.

    It is cut to what a verdict can be made of, since a subject may send gigabytes.
    """
    if isinstance(data, str):
        # A lone surrogate, as JSON may carry one, is no text: a verdict that quotes it could not be written down.
        text = data if data.isascii() else data[:limit].encode("utf-8", "replace").decode() + data[limit:]
        return (text if len(text) <= limit else f"{text[:limit]}…"), min(len(text), limit)
    if isinstance(data, dict):
        pairs = {key: _kept(value, limit) for key, value in data.items()}
        return {key: kept for key, (kept, _) in pairs.items()}, sum(size for _, size in pairs.values())
    if isinstance(data, (list, tuple)):
        items = [_kept(item, limit) for item in data[:limit]]
        return [kept for kept, _ in items], sum(size for _, size in items) + ITEM * len(items)
    return data, 0
