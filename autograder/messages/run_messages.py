"""The messages about a run: the judge starts, interrupts and stops the subject, which prints and exits.

The subject is in a notebook, or it is a program that the grader's workspace service runs.
"""

from __future__ import annotations

from typing import Any

import msgspec

from autograder.messages.json_lines import Message


class Ready(Message, frozen=True):
    """The other side has received everything that it needs, and is ready to start runs."""


class RunMessage(Message, frozen=True):
    """The common part of the messages about a run.

    Attributes:
        run: The number of the run, as in :class:`Start`.
    """

    run: int


# --- From the judge


class Start(RunMessage, frozen=True):
    """A request to make the node, call the function, or start the process. A workspace is built first.

    Attributes:
        arguments: The arguments of the class, function or program. If an exercise is about several programs, the first
            one chooses the program.
        fresh: True to make a new context first.
        options: Keyword arguments, which are passed if the subject has parameters with these names.
    """

    arguments: list[Any] = msgspec.field(default_factory=list)
    fresh: bool = False
    options: dict[str, Any] = msgspec.field(default_factory=dict)


class Interrupt(RunMessage, frozen=True):
    """A request to send Ctrl-C to the process. The run continues until the process ends or is stopped."""


class Stop(RunMessage, frozen=True):
    """A request to end the run."""


# --- To the judge


class Output(RunMessage, frozen=True):
    """A line that the subject has printed or logged."""

    text: str
    logged: bool = False


class Exited(RunMessage, frozen=True):
    """The process has ended by itself; the exit code is None if it is not known."""

    code: int | None = None


class Stopped(RunMessage, frozen=True):
    """The run is over: its nodes are destroyed, and its processes have ended."""
