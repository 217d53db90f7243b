"""The outcome of each file that was collected: to its place, among earlier attempts, or nowhere, with the reason."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path


class State(StrEnum):
    """The outcome of a file; each file has one of these."""

    PLACED = "placed"
    """It is in ``submitted``."""
    UNCHANGED = "unchanged"
    """The same is there already."""
    EARLIER = "earlier"
    """Another one counts; this one is kept."""
    BESIDE = "beside"
    """It is no notebook that was asked for, and its student has handed in one, or it is the LMS's own page."""
    NOT_PLACED = "not placed"
    """A line that waits for a person: it may be a student's work."""
    LEFT_OUT = "left out"
    """A person wrote ``no`` under ``use``."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one file.

    Attributes:
        label: The file's name in messages.
        state: The place where it went.
        reason: The reason why it is not at its place, and what to type; empty where it is there.
        student: The student's id; empty where it is not known.
        assignment: The assignment's name; empty where it is not known.
        when: The time of handing in, in UTC; None where nothing says it.
        late: Whether the LMS marks it as late.
        replaced: Whether another one lay at its place, which is kept.
        key: The key of its line in the table.
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
        unread_times: Times in names and lists that nobody could read.
        untimed: Students for whose work, collected now, nothing says the time of handing in; by assignment.
        missing: Students who have handed in nothing, by assignment.
        waiting: How many lines of the table wait for a person.
        by_their_names: Whether there is no list of students, so that folders have the LMS's names.
        notes: Times that were noted, names in a list that are no student's, empty downloads.
    """

    path: Path
    outcomes: tuple[Outcome, ...] = ()
    unread_times: tuple[str, ...] = ()
    untimed: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: dict[str, tuple[str, ...]] = field(default_factory=dict)
    waiting: int = 0
    by_their_names: bool = False
    notes: tuple[str, ...] = ()

    def having(self, state: State) -> tuple[Outcome, ...]:
        """The files that went there."""
        return tuple(one for one in self.outcomes if one.state == state)

    @property
    def exit_code(self) -> int:
        """0 when everything has its place; 2 if a line of these files waits for a person."""
        return 2 if self.having(State.NOT_PLACED) else 0
