"""The judge's record, and the questions an exercise asks of it."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence  # noqa: TC003  (what reads kept evidence needs the types)
from dataclasses import dataclass, field
from typing import Any

import re2

from environment.installation import COMMAND


@dataclass(frozen=True)
class Event:
    """One thing that happened.

    Attributes:
        t: Seconds of wall time since the part began.
        kind: What happened, such as ``message`` or ``goal``; docs/exercise-reference.md lists every kind with its data.
        name: The topic, service or action; the stream of an output line; what happened to the subject.
        data: The rest, as JSON-able values.
        sim: Simulated seconds where the judge stepped the clock, else None.
    """

    t: float
    kind: str
    name: str
    data: Mapping[str, Any] = field(default_factory=dict)
    sim: float | None = None

    @property
    def moment(self) -> float:
        """Seconds of the subject's time: simulated ones where the judge stepped its clock, else ``t``."""
        return self.t if self.sim is None else self.sim


@dataclass(frozen=True)
class Part:
    """One run of the subject: its inputs and the events in order."""

    name: str
    inputs: Mapping[str, Any] = field(default_factory=dict)
    events: Sequence[Event] = ()

    def of(self, kind: str, name: str | None = None) -> list[Event]:
        """The events of a kind, in order; only those of ``name`` where one is given."""
        return [e for e in self.events if e.kind == kind and (name is None or e.name == name)]

    def first(self, kind: str, name: str | None = None) -> Event | None:
        """The first event of a kind, or None."""
        return next((e for e in self.events if e.kind == kind and (name is None or e.name == name)), None)

    def said(self, *, after: Event | None = None) -> list[str]:
        """The subject's words (log lines, printed lines, what a function returned), in order.

        Args:
            after: Only what was said later than this event.
        """
        start = self.events.index(after) + 1 if after is not None else 0
        # A traceback that has begun before that event goes on after it.
        own = without_tracebacks(self.events)
        return [text for i, e in own if i >= start and (text := spoken_by(e)) is not None]

    def endpoints(self, role: str) -> dict[str, str]:
        """The subject's endpoints of a role that were on the graph at any time of this part: name -> type."""
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
        """True if a node of the subject's was there, for however short a time."""
        return bool(self.of("announced")) or any(survey.data.get("nodes") for survey in self.of("interface"))

    @property
    def ending(self) -> Event | None:
        """The end of the subject by itself: an event named ``exited``, ``returned`` or ``raised``; or None."""
        return next((e for e in self.events if e.kind == "subject" and e.name in _ENDINGS), None)

    @property
    def returned(self) -> str | None:
        """A function's value, as Python writes it (``"None"`` for nothing); None where no function has returned."""
        ending = self.ending
        return str(ending.data.get("value")) if ending is not None and ending.name == "returned" else None

    @functools.cached_property
    def traceback(self) -> str:
        """The last traceback that the subject showed, else an empty string; read once, as most mistakes ask for it.

        One that comes from being stopped by the judge does not count: it means nothing.
        """
        for event in reversed(self.events):
            if event.kind == "subject" and event.data.get("traceback"):
                return str(event.data["traceback"])
        # Stream by stream, and program by program below a launch: lines of one may come between those of another.
        streams: dict[str, list[str]] = {}
        for event in self.of("output"):
            stream, line = _stream_and_line(event)
            streams.setdefault(stream, []).append(line)
        return next(filter(None, (_traceback_in(streams[name]) for name in sorted(streams))), "")


_LAUNCHED = re2.compile(r"(?s)(\[[\w.]+-\d+\] )?(.*)")
"""A line of output, behind what a launch puts before the lines of its programs, such as ``[talker-1]``."""


def _stream_and_line(event: Event) -> tuple[str, str]:
    """The stream of an output line, with the program below a launch that wrote it, and the line without its prefix."""
    text = str(event.data["text"])
    if not text.startswith("["):
        return event.name, text
    program, line = _LAUNCHED.fullmatch(text).groups()
    return f"{event.name} {program}" if program else event.name, line


_ENDINGS = ("exited", "returned", "raised")
_OF_A_NOTEBOOK = ("started", "constructed", "never_constructed", "returned", "raised")
INTERRUPTED = "Ctrl-C"
"""The name of the event that stands where the judge has pressed Ctrl-C."""


_TRACEBACK = "Traceback (most recent call last)"
_IGNORED = "Exception ignored in"
"""The beginning of Python's words about an error in a destructor: it has stopped nothing, and often follows from what
did."""
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
"""The beginnings of lines of tracebacks and stacks, also where two threads print theirs at once.

A Python program that ends while a thread of it still spins is often aborted by the C++ runtime (``terminate called
without an active exception``), and faulthandler shows what ran.
"""
_FRAME = re2.compile(r'\s+File ".*", line \d+')


def without_tracebacks(events: Sequence[Event]) -> Iterator[tuple[int, Event]]:
    """All but the output lines of tracebacks, with their places: they quote the program, which is not what it says."""
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
"""The beginning of a runner's line about a build or a launched process. These are not the subject's words."""
_ROS2_RUN = "[ros2run]: "
"""The beginning of a line of ``ros2 run`` itself, as where the program exited with failure 3: that says nothing of
why."""
_PREFIX = re2.compile(r"^\[\w+\] \[[\d.]+\] \[(?P<logger>[^\]]*)\]: ")
"""The prefix that rcutils puts before a line on a terminal: level, time stamp, logger. These are nobody's words."""


_LIBRARIES = re2.compile(r"\.action_(client|server)$|^(rcl|rclpy|rcutils|rmw\w*)(\.|$)")
"""Loggers that speak for ROS itself, such as "Ignoring unexpected result response" (rclpy/action/client.py)."""
_COLOURS = r"(?:\x1b\[[\d;]*m)*"
_MIDDLEWARE = re2.compile(
    rf"^{_COLOURS}\d{{4}}-\d\d-\d\d [\d:.]+ .*\[{_COLOURS}\w+{_COLOURS} (Error|Warning)\]"
)
"""The beginning of a line of Fast DDS; on a busy machine it may complain beside the best of programs."""


def spoken_by(event: Event) -> str | None:
    """The subject's words in an event, without a terminal's prefix; None where it said nothing."""
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
    # Asked of every line at every event: the expression only of those that can be one.
    return ("Error]" in text or "Warning]" in text) and _MIDDLEWARE.match(text) is not None


def _traceback_in(lines: Sequence[str]) -> str:
    """The last Python traceback among lines of output, the way a terminal shows it.

    One that was cut off, as where the process died while it was printed, or where another thread printed its own in
    between, only counts where there is no other.
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
    """True of the lines of a traceback that end before the error's own words."""
    return len(traceback) < 2 or traceback[-1].startswith((" ", "\t", _TRACEBACK, *_OF_A_TRACEBACK))


def _traceback_at(lines: Sequence[str], start: int) -> list[str]:
    end = next(
        (i for i in range(start + 1, len(lines)) if lines[i] and not lines[i].startswith((" ", "\t"))),
        len(lines) - 1,
    )
    return [*lines[start : end + 1]]


@dataclass(frozen=True)
class Evidence:
    """All that a criterion or a mistake may look at.

    Attributes:
        parts: What was seen of the subject.
        reference: What was recorded of the reference solution: the expected behaviour.
        real_time: Whether this is the second look.
        before: What the first look brought, when this is the second.
    """

    parts: Sequence[Part]
    reference: Reference
    real_time: bool = False
    before: Evidence | None = None

    def part(self, name: str) -> Part:
        """The part of that name; an empty one where the scenario did not get so far."""
        return next((part for part in self.parts if part.name == name), Part(name))

    @property
    def main(self) -> Part:
        """The first part."""
        return self.parts[0] if self.parts else Part("nothing")

    @property
    def in_a_notebook(self) -> bool:
        """True if the subject is a class or a function of a notebook, and not a program."""
        return any(e.kind == "subject" and e.name in _OF_A_NOTEBOOK for part in self for e in part.events)

    def ever_had(self, role: str) -> bool:
        """True if an endpoint was seen in any run of both looks: who ends at once may be gone before it is known."""
        return any(part.endpoints(role) for part in (*self, *(self.before or ())))

    def __iter__(self) -> Iterator[Part]:
        return iter(self.parts)


@dataclass(frozen=True)
class Reference:
    """A reference output: what the reference solution does on the wire.

    Attributes:
        exercise: The exercise's id.
        interface: Role -> {name: type} of the reference solution's endpoints.
        parts: What was seen of it, in the same parts as any subject's.
    """

    exercise: str
    interface: Mapping[str, Mapping[str, str]]
    parts: Sequence[Part] = ()

    def part(self, name: str) -> Part:
        """The part of that name.

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
        """The name and type of the one endpoint of a role.

        Raises:
            KeyError: The reference solution has none of this role.
        """
        for name, type_name in sorted(self.interface.get(role, {}).items()):
            return name, type_name
        raise KeyError(f"the reference solution of {self.exercise} has no {role}: is the master right?")
