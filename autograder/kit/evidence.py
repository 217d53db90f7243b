"""The judge's records of a subject, and methods with which exercises read it."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping, Sequence  # noqa: TC003  (what reads kept evidence needs the types)
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import re2

from autograder.command_name import COMMAND
from autograder.kit.output.spoken_lines import spoken_by

if TYPE_CHECKING:
    from autograder.kit.oracle.naming.deltas import Mutants


@dataclass(frozen=True)
class Event:
    """One recorded event.

    Attributes:
        t: Wall time in seconds since the part began.
        kind: What happened, such as ``message`` or ``goal``; docs/exercise-reference.md lists every kind with its data.
        name: The topic, service or action. For a line of output, this is the stream; for the subject itself, what
            happened to it, such as ``exited``.
        data: Further fields of the event, as values that JSON can contain.
        sim: Simulated time in seconds if the judge stepped the clock, else None.
    """

    t: float
    kind: str
    name: str
    data: Mapping[str, Any] = field(default_factory=dict)
    sim: float | None = None

    @property
    def moment(self) -> float:
        """The event's time in seconds: simulated time if the judge stepped the clock, else ``t``."""
        return self.t if self.sim is None else self.sim


@dataclass(frozen=True)
class Part:
    """One run of the subject: the inputs, and the recorded events in order of time."""

    name: str
    inputs: Mapping[str, Any] = field(default_factory=dict)
    events: Sequence[Event] = ()

    def of(self, kind: str, name: str | None = None) -> list[Event]:
        """Return the events of a kind, in order of time. If ``name`` is given, return only those with this name."""
        return [e for e in self.events if e.kind == kind and (name is None or e.name == name)]

    def first(self, kind: str, name: str | None = None) -> Event | None:
        """Return the first event of a kind; with ``name``, the first one with this name. None if there is none."""
        return next((e for e in self.events if e.kind == kind and (name is None or e.name == name)), None)

    def said(self, *, after: Event | None = None) -> list[str]:
        """Return the lines that the subject logged, printed or returned, in order of time, without tracebacks.

        Args:
            after: If given, only lines after this event are returned.
        """
        start = 0 if after is None else self._place_behind(after)
        return [text for i, text in self._spoken if i >= start]

    def _place_behind(self, event: Event) -> int:
        try:
            return self.events.index(event) + 1
        except ValueError:
            # A line of a subject that said so much that the recorder has dropped its older lines.
            return sum(one.t <= event.t for one in self.events)

    @functools.cached_property
    def _spoken(self) -> list[tuple[int, str]]:
        """The subject's lines, each with the index of its event. A verdict asks for them a hundred times."""
        # A traceback may begin before an event and continue beyond it, so all events are read.
        own = without_tracebacks(self.events)
        return [(i, text) for i, event in own if (text := spoken_by(event)) is not None]

    def endpoints(self, role: str) -> dict[str, str]:
        """Return all endpoints of a role that the subject had on the ROS graph in this part, as name -> type."""
        found: dict[str, str] = {}
        for survey in self.of("interface"):
            found |= survey.data.get(role, {})
        return found

    def qos(self, role: str) -> dict[str, str]:
        """Return each QoS of the endpoints of a role that is not the default one, such as name -> ``"sensor"``."""
        unusual = (end for survey in self.of("interface") for end in survey.data.get("qos", ()))
        return {name: qos for of, name, qos in unusual if of == role}

    def real_name(self, name: str) -> str:
        """Return the name that the subject used instead of the task's ``name``; the same name if it used that."""
        event = self.first("misnamed", name)
        return name if event is None else str(event.data["real"])

    @property
    def had_node(self) -> bool:
        """True if the subject had a node, even for a short time."""
        return bool(self.of("announced")) or any(survey.data.get("nodes") for survey in self.of("interface"))

    @property
    def ending(self) -> Event | None:
        """The event with which the subject ended by itself (``exited``, ``returned`` or ``raised``), or None."""
        return next((e for e in self.events if e.kind == "subject" and e.name in _ENDINGS), None)

    @property
    def returned(self) -> str | None:
        """The repr of the value that a function returned, such as ``"None"``; None if no function has returned."""
        ending = self.ending
        return str(ending.data.get("value")) if ending is not None and ending.name == "returned" else None

    @functools.cached_property
    def traceback(self) -> str:
        """The last traceback that the subject printed; empty if there is none.

        A traceback does not count if it appears only because the judge stopped the subject.
        """
        for event in reversed(self.events):
            if event.kind == "subject" and event.data.get("traceback"):
                return str(event.data["traceback"])
        # Each stream is searched alone, and under a launch each program, because their lines may be mixed.
        streams: dict[str, list[str]] = {}
        for event in self.of("output"):
            stream, line = _stream_and_line(event)
            streams.setdefault(stream, []).append(line)
        return next(filter(None, (_traceback_in(streams[name]) for name in sorted(streams))), "")


_LAUNCHED = re2.compile(r"(?s)(\[[\w.]+-\d+\] )?(.*)")
"""Splits a line of output into the prefix that a launch adds, such as ``[talker-1]``, and the program's own words."""


def _stream_and_line(event: Event) -> tuple[str, str]:
    """Return the stream of an output line, and the line without its prefix.

    Under a launch, the stream contains the name of the program, too.
    """
    text = str(event.data["text"])
    if not text.startswith("["):
        return event.name, text
    program, line = _LAUNCHED.fullmatch(text).groups()
    return f"{event.name} {program}" if program else event.name, line


_ENDINGS = ("exited", "returned", "raised")
_OF_A_NOTEBOOK = ("started", "constructed", "never_constructed", "returned", "raised")
INTERRUPTED = "Ctrl-C"
"""The name of the event recorded when the judge pressed Ctrl-C."""


_TRACEBACK = "Traceback (most recent call last)"
_IGNORED = "Exception ignored in"
"""The beginning of Python's message about an error in a destructor. Such an error is not the mistake to show, because
it does not stop the program, and is often the consequence of another error.
"""
_OF_A_TRACEBACK = (
    "Exception in thread ",
    _IGNORED,
    "terminate called ",
    "Fatal Python error: ",
    "Extension modules: ",
    "  <no Python frame>",
    "Thread 0x",
    "Current thread",
    # Python 3.14 adds the calls of compiled code, below the words "Current thread's C stack trace".
    "  Binary file ",
    "  <truncated rest of calls>",
    "  <cannot get C stack on this system>",
    "During handling of the above exception",
    "The above exception was the direct cause",
)
"""The beginnings of lines that belong to tracebacks or stacks, even if two threads print tracebacks at the same time.

For example, if a Python program ends while one of its threads still spins, the C++ runtime often aborts it
(``terminate called without an active exception``), and faulthandler then prints the stacks.
"""
_FRAME = re2.compile(r'\s+File ".*", line \d+')
_SEGFAULT = "Fatal Python error: Segmentation fault"
_STACK_FRAME = re2.compile(r'(  File ".*", line \d+)( in .*)')
_LOGGING_ERROR = "--- Logging error ---"
_OF_A_LOGGING_ERROR = ("Call stack:", "    ", "Message: ", "Arguments: ")
"""The beginnings of the lines that Python's ``logging`` prints after the traceback of an error in a log call.

The line with the last of these beginnings ends the block.
"""


def without_tracebacks(events: Sequence[Event]) -> Iterator[tuple[int, Event]]:
    """Yield each event with its index, but no lines of tracebacks.

    The lines that ``logging`` prints about a failed log call are left out, too.
    """
    inside: dict[str, bool] = {}
    failed_to_log: set[str] = set()
    for place, event in enumerate(events):
        if event.kind == "output":
            stream, line = _stream_and_line(event)
            if line.startswith(_OF_A_TRACEBACK) or (line[:1].isspace() and _FRAME.match(line)):
                continue
            if inside.get(stream) or line.startswith(_TRACEBACK):
                inside[stream] = line.startswith(("Traceback", " ", "\t")) or not line
                continue
            if line.startswith(_LOGGING_ERROR):
                failed_to_log.add(stream)
            if stream in failed_to_log and line.startswith(_OF_A_LOGGING_ERROR):
                if line.startswith(_OF_A_LOGGING_ERROR[-1]):
                    failed_to_log.remove(stream)
                continue
        yield place, event


def _traceback_in(lines: Sequence[str]) -> str:
    """Return the last Python traceback in lines of output, as a terminal would show it.

    A traceback that was cut off, because the process died or another thread printed in between, counts only if no
    complete one exists. A crash in compiled code ended the process, so its stack is the last traceback.
    """
    if _SEGFAULT in lines:
        return _as_traceback(lines[lines.index(_SEGFAULT) :])
    starts = [
        i
        for i, line in enumerate(lines)
        if line.startswith(_TRACEBACK) and not (i and lines[i - 1].startswith(_IGNORED))
    ]
    syntax = [i for i, line in enumerate(lines) if line.startswith("  File ") and i not in starts]
    if not starts:
        # Python prints a SyntaxError in the program itself without the line "Traceback".
        ends = [
            i
            for i, line in enumerate(lines)
            if line.startswith(("SyntaxError", "IndentationError", "TabError"))
        ]
        return "\n".join(lines[syntax[0] : ends[-1] + 1]) if ends and syntax else ""
    found = [_traceback_at(lines, start) for start in starts]
    return "\n".join(next((taken for taken in reversed(found) if not is_cut_off(taken)), found[-1]))


def _as_traceback(stacks: Sequence[str]) -> str:
    """Return the stack of the thread that crashed, as faulthandler prints it, in the form of a traceback."""
    crashed = itertools.dropwhile(lambda line: not line.startswith("Current thread"), stacks)
    frames = [_STACK_FRAME.sub(r"\1,\2", line) for line in itertools.takewhile(bool, crashed)]
    return "\n".join([f"{_TRACEBACK}:", *frames[:0:-1], _SEGFAULT.partition(": ")[2]])


def is_cut_off(traceback: Sequence[str]) -> bool:
    """Return True if the lines of a traceback stop before the error's own message."""
    return len(traceback) < 2 or traceback[-1].startswith((" ", "\t", _TRACEBACK, *_OF_A_TRACEBACK))


def _traceback_at(lines: Sequence[str], start: int) -> list[str]:
    end = next(
        (i for i in range(start + 1, len(lines)) if lines[i] and not lines[i].startswith((" ", "\t"))),
        len(lines) - 1,
    )
    return [*lines[start : end + 1]]


@dataclass(frozen=True)
class Evidence:
    """Everything from which criteria and mistakes decide.

    Attributes:
        parts: The runs of the subject, one for each part of the scenario.
        reference: The record of the reference solution: the expected behavior.
        real_time: True if this is the second look, in which the judge does not speed up time.
        before: In the second look, the evidence of the first one; else None.
    """

    parts: Sequence[Part]
    reference: Reference
    real_time: bool = False
    before: Evidence | None = None

    def part(self, name: str) -> Part:
        """Return the part with a given name; an empty part if the scenario ended before that part."""
        return next((part for part in self.parts if part.name == name), Part(name))

    @property
    def main(self) -> Part:
        """The first part."""
        return self.parts[0] if self.parts else Part("nothing")

    @property
    def in_a_notebook(self) -> bool:
        """True if the subject is a class or a function in a notebook; False if it is a program."""
        return any(e.kind == "subject" and e.name in _OF_A_NOTEBOOK for part in self for e in part.events)

    def ever_had(self, role: str) -> bool:
        """Return True if the subject had an endpoint of this role in any run.

        If this is the second look, the first look (:attr:`before`) counts, too, because an endpoint that exists only
        briefly may be missed in one of them.
        """
        return any(part.endpoints(role) for part in (*self, *(self.before or ())))

    def __iter__(self) -> Iterator[Part]:
        return iter(self.parts)


@dataclass(frozen=True)
class Variant:
    """The judge's record of a wrong answer of the bank, with the text for a student whose node does the same.

    Attributes:
        key: The key of the mistake.
        text: What the node does wrong.
        next_step: What the student should do now.
        parts: The record of the wrong answer, with the same parts as the reference solution's.
    """

    key: str
    text: str
    next_step: str
    parts: Sequence[Part]


@dataclass(frozen=True)
class Reference:
    """A reference output: what the judge recorded on the wire when it ran the reference solution.

    Attributes:
        exercise: The exercise's id.
        interface: For each role, the types of the reference solution's endpoints by name.
        parts: The record of the reference solution, with the same parts as a subject's.
        variants: The records of wrong answers that a card can name.
        qos: For each role, the QoS of the reference solution's endpoints by name, if it is not the default one.
        drawings: The names of the drawings to record; empty for the practice drawings of the exercise.
        mutants: What the mutants of the solution do in the practice drawings; None if that was not recorded.
    """

    exercise: str
    interface: Mapping[str, Mapping[str, str]]
    parts: Sequence[Part] = ()
    variants: Sequence[Variant] = ()
    qos: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    drawings: Sequence[str] = ()
    mutants: Mutants | None = None

    @property
    def knows_wrong_answers(self) -> bool:
        """True if a wrong answer may be known in the practice drawings."""
        return bool(self.variants) or self.mutants is not None

    def part(self, name: str) -> Part:
        """Return the part with this name.

        Raises:
            KeyError: The reference output has no such part, so it has to be recorded again.
        """
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(
            f"the reference output of {self.exercise} has no part {name!r}: run `{COMMAND} record`"
        )

    def only(self, role: str) -> tuple[str, str]:
        """Return the name and type of the reference solution's only endpoint of a role.

        Raises:
            KeyError: The reference solution has no endpoint of this role.
        """
        for name, type_name in sorted(self.interface.get(role, {}).items()):
            return name, type_name
        raise KeyError(f"the reference solution of {self.exercise} has no {role}: is the master right?")
