"""The record of everything that the judge sees in one part, in order of time. Any thread may write to it."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from autograder.judge.bench.unreadable import FLOOD, UnreadableSubject
from autograder.judge.machine_fitness import Patience
from autograder.kit.evidence import Event, Part
from autograder.kit.output.spoken_lines import REPORTS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from autograder.judge.bench.judge_nodes import Wire

MAX_EVENTS = 20_000
"""The maximum number of events in one part, so that a flood does not fill the memory. The event after these is the last
that is recorded; it shows that the subject said and sent too much.
"""
MAX_SAID = 1_000_000
"""The maximum number of characters of output and log in one part. If a subject writes more, the oldest are dropped."""
MAX_TEXT = 50_000
"""The maximum number of characters in a text, and of items in a list: far more than in any message of the course, and
just enough for a stack.
"""
MAX_TEXTS = 20_000_000
"""The maximum number of characters in all texts of a part. After that, only the beginning of each text is kept."""
BEGINNING = 100
ITEM = 32
"""The number of characters that each item of a list adds to the size of an event. Without it, a long list of numbers
would have the size 0 although it takes memory.
"""
MAX_NAME = 300
"""The maximum number of characters in a name; DDS allows 255."""
_SPEECH = ("output", "log")


class Recorder:
    """The events of one part, in order of time. Threads can wait for the next event.

    Each part has a recorder of its own. So an answer or a line that arrives after its part has ended, because the
    machine is busy, is never taken for one of the next part.

    Attributes:
        take_in: A function that waits until everything that was sent to the judge so far is recorded.
        simulated_now: The simulated time, in seconds, which is stored with each event; None in real time.
        began_at: The Unix time at which the part began. The times of events are in seconds since then.
    """

    def __init__(
        self,
        name: str = "",
        inputs: Mapping[str, Any] = MappingProxyType({}),
        hurry: Callable[[], None] = lambda: None,
    ) -> None:
        """Begin a part.

        Args:
            hurry: Called repeatedly during each wait. It may end the wait by raising an exception.
        """
        self._hurry = hurry
        self._changed = threading.Condition()
        self._events: list[Event] = []
        self._count = 0
        self._said = 0
        self._size = 0
        self._name = name
        self._inputs = dict(inputs)
        self._start = time.monotonic()
        self.take_in: Callable[[], object] = lambda: None
        self.simulated_now: float | None = None
        self.began_at = time.time()

    def end(self, name: str, known: Callable[[], object], **data: Any) -> None:
        """Record that the subject has ended. The time of the event is the time of this call.

        The event comes after everything that the subject has sent.

        Args:
            name: The kind of end, such as ``"exited"``.
            known: Called when the end is recorded, before any waiting thread can see it.
            data: Data about the end.
        """
        moment = time.monotonic()
        self.take_in()
        with self._changed:
            self._record("subject", name, data, moment)
            known()

    def record(self, kind: str, name: str, **data: Any) -> None:
        """Record an event, and wake every thread that waits for one."""
        self._record(kind, name, data)

    def _record(self, kind: str, name: str, data: Mapping[str, Any], moment: float | None = None) -> None:
        kept, size = _kept(data, MAX_TEXT if self._size < MAX_TEXTS else BEGINNING)
        with self._changed:
            self._count += 1
            self._size += size
            if kind in _SPEECH:
                self._said += size
            if self._said > MAX_SAID or len(self._events) == MAX_EVENTS:
                self._forget_old_words()
            if not self._is_full:
                t = (time.monotonic() if moment is None else moment) - self._start
                self._events.append(Event(t, kind, name[:MAX_NAME], kept, self.simulated_now))
            self._changed.notify_all()

    @property
    def _is_full(self) -> bool:
        return len(self._events) > MAX_EVENTS

    def _forget_old_words(self) -> None:
        """Drop the older half of the subject's output, so that much output does not displace other events."""
        words = [event for event in self._events if _is_speech(event)]
        old = {id(event) for event in words[: len(words) // 2 + 1]}
        self._events = [event for event in self._events if id(event) not in old]
        self._said = sum(len(event.data["text"]) for event in self._events if _is_speech(event))

    @property
    def moment(self) -> float:
        """The subject's time now, in seconds: simulated time, or the time since the part began."""
        now = self.simulated_now
        return time.monotonic() - self._start if now is None else now

    @property
    def count(self) -> int:
        """The number of events so far, with those that were dropped."""
        return self._count

    def part(self) -> Part:
        """Return the part with its events so far."""
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
        """Wait until ``condition`` holds, which is checked again after every event.

        Args:
            condition: Called in the waiting thread, without holding the recorder's lock.
            within: The limit in seconds of patience (:mod:`autograder.judge.machine_fitness`).
            poll: Seconds until the condition is checked again without an event. A few milliseconds if the condition
                queries the graph, because changes of the graph are not events.
            quiet: Give up earlier if nothing was recorded for this many seconds of patience.
            wall: True to count wall time: for a wait that is a step of the scenario and not a limit for the subject.

        Returns:
            True if the condition held in time.

        Raises:
            UnreadableSubject: The record is full, although the older words were dropped. What comes now is not in it.
        """
        slowness = (lambda: 1.0) if wall else None
        patience = Patience(within, slowness=slowness)
        silence = None if quiet is None else Patience(quiet, slowness=slowness)
        heard = self._count
        while True:
            self._hurry()
            if self._is_full:
                raise UnreadableSubject(FLOOD)
            # Read the count before the condition, so that an event during the check is not slept through below.
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


@dataclass(frozen=True)
class Place:
    """The place of an endpoint of the judge, and the recorder of its events.

    Attributes:
        wire: The judge's participant.
        recorder: The record of the part.
        name: The full name of the topic, service or action as the evidence shows it.
        type_name: The endpoint's type, such as ``"std_msgs/msg/String"``.
        at: The name that the subject uses, which is different if the subject has misspelled it.
    """

    wire: Wire
    recorder: Recorder
    name: str
    type_name: str
    at: str

    def record(self, kind: str, **data: Any) -> None:
        """Record an event of the endpoint."""
        self.recorder.record(kind, self.name, **data)


def _is_speech(event: Event) -> bool:
    """Return True if an event contains the subject's own words, not a runner's report about a build or a launch."""
    return event.kind in _SPEECH and not str(event.data.get("text", "")).startswith(REPORTS)


def _kept(data: Any, limit: int) -> tuple[Any, int]:
    """Return a shortened copy of an event's data, and the size of the copy in characters.

    Texts and lists are cut to a length that a verdict can use, because a subject may send gigabytes.
    """
    if isinstance(data, str):
        # Text from JSON may contain a lone surrogate, which UTF-8 cannot encode. Replace it, because otherwise a
        # verdict that quotes the text could not be written.
        text = data if data.isascii() else data[:limit].encode("utf-8", "replace").decode() + data[limit:]
        return (text if len(text) <= limit else f"{text[:limit]}…"), min(len(text), limit)
    if isinstance(data, dict):
        pairs = {key: _kept(value, limit) for key, value in data.items()}
        return {key: kept for key, (kept, _) in pairs.items()}, sum(size for _, size in pairs.values())
    if isinstance(data, (list, tuple)):
        items = [_kept(item, limit) for item in data[:limit]]
        return [kept for kept, _ in items], sum(size for _, size in items) + ITEM * len(items)
    return data, 0
