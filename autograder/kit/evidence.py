"""The judge's record of a subject, and the questions that exercises ask about it."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence  # noqa: TC003  (what reads kept evidence needs the types)
from dataclasses import dataclass, field
from typing import Any

import re2

from environment.installation import COMMAND


@dataclass(frozen=True)
class Event:
    """One recorded event.

    Attributes:
        t: Seconds of wall time since the part began.
        kind: What happened, such as ``message`` or ``goal``; docs/exercise-reference.md lists every kind with its data.
        name: The topic, service or action; the stream of an output line; what happened to the subject.
        data: The rest, as JSON-able values.
        sim: Simulated seconds if the judge stepped the clock, else None.
    """

    t: float
    kind: str
    name: str
    data: Mapping[str, Any] = field(default_factory=dict)
    sim: float | None = None

    @property
    def moment(self) -> float:
        """Seconds of the subject's time: simulated if the judge stepped its clock, else ``t``."""
        return self.t if self.sim is None else self.sim


@dataclass(frozen=True)
class Part:
    """One run of the subject: its inputs and the events in order."""

    name: str
    inputs: Mapping[str, Any] = field(default_factory=dict)
    events: Sequence[Event] = ()

    def of(self, kind: str, name: str | None = None) -> list[Event]:
        """Return the events of a kind, in order; only those of ``name`` if it is given."""
        return [e for e in self.events if e.kind == kind and (name is None or e.name == name)]

    def first(self, kind: str, name: str | None = None) -> Event | None:
        """The first event of a kind, or None."""
        return next((e for e in self.events if e.kind == kind and (name is None or e.name == name)), None)

    def said(self, *, after: Event | None = None) -> list[str]:
        """Return the subject's words (log lines, printed lines, a function's value), in order.

        Args:
            after: Only words after this event.
        """
        start = self.events.index(after) + 1 if after is not None else 0
        # A traceback that began before that event continues after it.
        own = without_tracebacks(self.events)
        return [text for i, e in own if i >= start and (text := spoken_by(e)) is not None]

    def endpoints(self, role: str) -> dict[str, str]:
        """Return the subject's endpoints of a role that were ever on the graph in this part: name -> type."""
        found: dict[str, str] = {}
        for survey in self.of("interface"):
            found |= survey.data.get(role, {})
        return found

    def real_name(self, name: str) -> str:
        """Return the subject's name for what the task calls ``name``: another one if the subject misnamed it."""
        event = self.first("misnamed", name)
        return name if event is None else str(event.data["real"])

    @property
    def had_node(self) -> bool:
        """True if the subject had a node, even for a short time."""
        return bool(self.of("announced")) or any(survey.data.get("nodes") for survey in self.of("interface"))

    @property
    def ending(self) -> Event | None:
        """How the subject ended by itself: an event named ``exited``, ``returned`` or ``raised``; or None."""
        return next((e for e in self.events if e.kind == "subject" and e.name in _ENDINGS), None)

    @property
    def returned(self) -> str | None:
        """A function's value, as Python writes it (``"None"`` for nothing); None if no function has returned."""
        ending = self.ending
        return str(ending.data.get("value")) if ending is not None and ending.name == "returned" else None

    @functools.cached_property
    def traceback(self) -> str:
        """The last traceback that the subject showed, else empty; cached, because most mistakes need it.

        A traceback from being stopped by the judge does not count.
        """
        for event in reversed(self.events):
            if event.kind == "subject" and event.data.get("traceback"):
                return str(event.data["traceback"])
        # Separately for each stream, and for each program below a launch, because their lines may be mixed.
        streams: dict[str, list[str]] = {}
        for event in self.of("output"):
            stream, line = _stream_and_line(event)
            streams.setdefault(stream, []).append(line)
        return next(filter(None, (_traceback_in(streams[name]) for name in sorted(streams))), "")


_LAUNCHED = re2.compile(r"(?s)(\[[\w.]+-\d+\] )?(.*)")
"""A line of output, after the prefix that a launch puts before its programs' lines, such as ``[talker-1]``."""


def _stream_and_line(event: Event) -> tuple[str, str]:
    """Return the stream of an output line, with its program below a launch, and the line without its prefix."""
    text = str(event.data["text"])
    if not text.startswith("["):
        return event.name, text
    program, line = _LAUNCHED.fullmatch(text).groups()
    return f"{event.name} {program}" if program else event.name, line


_ENDINGS = ("exited", "returned", "raised")
_OF_A_NOTEBOOK = ("started", "constructed", "never_constructed", "returned", "raised")
INTERRUPTED = "Ctrl-C"
"""The name of the event that records that the judge pressed Ctrl-C."""


_TRACEBACK = "Traceback (most recent call last)"
_IGNORED = "Exception ignored in"
"""The beginning of Python's message about an error in a destructor: it stops nothing, and is often a consequence of
another error.
"""
_OF_A_TRACEBACK = (
    "Exception in thread ",
    _IGNORED,
    "terminate called ",
    "Fatal Python error: ",
    "Extension modules: ",
    "  <no Python frame>",
    "Thread 0x",
    "Current thread 0x",
    "During handling of the above exception",
    "The above exception was the direct cause",
)
"""The beginnings of lines of tracebacks and stacks, even if two threads print theirs at once.

A Python program that ends while one of its threads still spins is often aborted by the C++ runtime (``terminate
called without an active exception``), and faulthandler prints the stacks.
"""
_FRAME = re2.compile(r'\s+File ".*", line \d+')


def without_tracebacks(events: Sequence[Event]) -> Iterator[tuple[int, Event]]:
    """Yield all events with their indexes, except lines of tracebacks: these quote the program, not its words."""
    inside: dict[str, bool] = {}
    for place, event in enumerate(events):
        if event.kind == "output":
            stream, line = _stream_and_line(event)
            if line.startswith(_OF_A_TRACEBACK) or (line[:1].isspace() and _FRAME.match(line)):
                continue
            if inside.get(stream) or line.startswith(_TRACEBACK):
                inside[stream] = line.startswith(("Traceback", " ", "\t")) or not line
                continue
        yield place, event


REPORTS = ("@workspace ", "@process ")
"""The beginning of a runner's line about a build or a launched process. Such lines are not the subject's words."""
_ROS2_RUN = "[ros2run]: "
"""The beginning of a line of ``ros2 run`` itself, such as that the program exited with failure 3: it does not tell
why.
"""
_PREFIX = re2.compile(r"^\[\w+\] \[[\d.]+\] \[(?P<logger>[^\]]*)\]: ")
"""The prefix that rcutils puts before a line on a terminal: level, time stamp, logger.

It is not the subject's words.
"""


_LIBRARIES = re2.compile(r"\.action_(client|server)$|^(rcl|rclpy|rcutils|rmw\w*)(\.|$)")
"""Loggers of ROS itself, for lines such as "Ignoring unexpected result response" (rclpy/action/client.py)."""
_COLOURS = r"(?:\x1b\[[\d;]*m)*"
_MIDDLEWARE = re2.compile(
    rf"^{_COLOURS}\d{{4}}-\d\d-\d\d [\d:.]+ .*\[{_COLOURS}\w+{_COLOURS} (Error|Warning)\]"
)
"""The beginning of a line of Fast DDS, which on a busy machine may complain even about a perfect program."""


def spoken_by(event: Event) -> str | None:
    """Return the subject's words in an event, without a terminal's prefix; None if the event has none."""
    if event.kind in ("log", "output"):
        text = str(event.data["text"])
        prefix = _PREFIX.match(text) if text.startswith("[") else None
        logger = event.name if event.kind == "log" else prefix["logger"] if prefix else ""
        if (
            text.startswith((*REPORTS, _ROS2_RUN))
            or (logger and _is_a_library(logger))
            or _is_the_middlewares(text)
        ):
            return None
        return text[prefix.end() :] if prefix else text
    if event.kind == "subject" and event.name == "returned" and event.data.get("value") is not None:
        return str(event.data["value"])
    return None


@functools.lru_cache(maxsize=256)
def _is_a_library(logger: str) -> bool:
    return _LIBRARIES.search(logger) is not None


def _is_the_middlewares(text: str) -> bool:
    # This is called for every line at every event, so the slow expression runs only for likely lines.
    return ("Error]" in text or "Warning]" in text) and _MIDDLEWARE.match(text) is not None


def _traceback_in(lines: Sequence[str]) -> str:
    """Return the last Python traceback among lines of output, as a terminal shows it.

    A traceback that was cut off, because the process died or another thread printed in between, counts only if there
    is no other.
    """
    starts = [
        i
        for i, line in enumerate(lines)
        if line.startswith(_TRACEBACK) and not (i and lines[i - 1].startswith(_IGNORED))
    ]
    syntax = [i for i, line in enumerate(lines) if line.startswith("  File ") and i not in starts]
    if not starts:
        # A SyntaxError in the program itself is shown without the word "Traceback".
        ends = [
            i
            for i, line in enumerate(lines)
            if line.startswith(("SyntaxError", "IndentationError", "TabError"))
        ]
        return "\n".join(lines[syntax[0] : ends[-1] + 1]) if ends and syntax else ""
    found = [_traceback_at(lines, start) for start in starts]
    return "\n".join(next((taken for taken in reversed(found) if not is_cut_off(taken)), found[-1]))


def is_cut_off(traceback: Sequence[str]) -> bool:
    """True if the lines of a traceback end before the error's own message."""
    return len(traceback) < 2 or traceback[-1].startswith((" ", "\t", _TRACEBACK, *_OF_A_TRACEBACK))


def _traceback_at(lines: Sequence[str], start: int) -> list[str]:
    end = next(
        (i for i in range(start + 1, len(lines)) if lines[i] and not lines[i].startswith((" ", "\t"))),
        len(lines) - 1,
    )
    return [*lines[start : end + 1]]


@dataclass(frozen=True)
class Evidence:
    """Everything that a criterion or a mistake may use.

    Attributes:
        parts: The record of the subject.
        reference: The record of the reference solution: the expected behavior.
        real_time: True if this is the second look.
        before: The result of the first look, in the second one.
    """

    parts: Sequence[Part]
    reference: Reference
    real_time: bool = False
    before: Evidence | None = None

    def part(self, name: str) -> Part:
        """Return the part of that name; an empty one if the scenario did not get so far."""
        return next((part for part in self.parts if part.name == name), Part(name))

    @property
    def main(self) -> Part:
        """The first part."""
        return self.parts[0] if self.parts else Part("nothing")

    @property
    def in_a_notebook(self) -> bool:
        """True if the subject is a class or a function of a notebook, not a program."""
        return any(e.kind == "subject" and e.name in _OF_A_NOTEBOOK for part in self for e in part.events)

    def ever_had(self, role: str) -> bool:
        """True if any run of both looks has such an endpoint: one that ends at once may be gone before it is seen."""
        return any(part.endpoints(role) for part in (*self, *(self.before or ())))

    def __iter__(self) -> Iterator[Part]:
        return iter(self.parts)


@dataclass(frozen=True)
class Reference:
    """A reference output: the behavior of the reference solution on the wire.

    Attributes:
        exercise: The exercise's id.
        interface: Role -> {name: type} of the reference solution's endpoints.
        parts: Its record, in the same parts as any subject's.
    """

    exercise: str
    interface: Mapping[str, Mapping[str, str]]
    parts: Sequence[Part] = ()

    def part(self, name: str) -> Part:
        """Return the part of that name.

        Raises:
            KeyError: The reference output has no such part: it must be recorded again.
        """
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(
            f"the reference output of {self.exercise} has no part {name!r}: run `{COMMAND} record`"
        )

    def only(self, role: str) -> tuple[str, str]:
        """Return the name and type of the only endpoint of a role.

        Raises:
            KeyError: The reference solution has none of this role.
        """
        for name, type_name in sorted(self.interface.get(role, {}).items()):
            return name, type_name
        raise KeyError(f"the reference solution of {self.exercise} has no {role}: is the master right?")
