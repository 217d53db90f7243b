"""The outcome for each collected file: it is at its place, it is an earlier attempt, or it waits, with the reason."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path


class State(StrEnum):
    """The state of a file after collecting. Each file has exactly one of these."""

    PLACED = "placed"
    """The file is in ``submitted``."""
    UNCHANGED = "unchanged"
    """The same file was already in ``submitted``."""
    EARLIER = "earlier"
    """Another file counts. This one is kept as an earlier attempt."""
    BESIDE = "beside"
    """The file is not one of the notebooks to collect, and its student has handed in such a notebook; or it is a page
    of the LMS.
    """
    NOT_PLACED = "not placed"
    """The file waits for a person, because it may be a student's work."""
    LEFT_OUT = "left out"
    """A person wrote ``no`` under ``use``."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one file.

    Attributes:
        label: The name of the file in messages.
        state: The state of the file.
        reason: Why the file is not at its place, and what to type; empty if it is at its place.
        student: The student's id; empty if unknown.
        assignment: The assignment's name; empty if unknown.
        when: The time of handing in, in the time zone of the class; None if unknown.
        late: True if the LMS marks the file as late.
        replaced: True if another file was at its place before. That file is kept.
        key: The key of the file's line in the table.
    """

    label: str
    state: State
    reason: str = ""
    student: str = ""
    assignment: str = ""
    when: datetime | None = None
    late: bool = False
    replaced: bool = False
    key: str = ""


@dataclass(frozen=True)
class CollectReport:
    """The result of collecting.

    Attributes:
        path: The class.
        outcomes: The outcome of each file.
        untimed: The students with work collected now whose time of handing in is unknown, by assignment.
        missing: The students who have handed in nothing, by assignment.
        waiting: The number of lines in the table that wait for a person.
        notes: Sentences for the instructor, for example about recorded times, names in a list that are not students,
            and empty downloads.
    """

    path: Path
    outcomes: tuple[Outcome, ...] = ()
    untimed: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: dict[str, tuple[str, ...]] = field(default_factory=dict)
    waiting: int = 0
    notes: tuple[str, ...] = ()

    def having(self, state: State) -> tuple[Outcome, ...]:
        """Return the outcomes with this state."""
        return tuple(one for one in self.outcomes if one.state == state)

    @property
    def exit_code(self) -> int:
        """The command's exit code: 0 if every file is settled; 2 if a line of these files waits for a person."""
        return 2 if self.having(State.NOT_PLACED) else 0
