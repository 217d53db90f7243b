"""The outcome of each collected file: its place, among earlier attempts, or nowhere, with the reason."""

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
    """The file is in ``submitted``."""
    UNCHANGED = "unchanged"
    """The same file is already there."""
    EARLIER = "earlier"
    """Another file counts; this one is kept."""
    BESIDE = "beside"
    """The file is not a requested notebook, and its student has handed in one; or it is the LMS's own page."""
    NOT_PLACED = "not placed"
    """The file waits for a person: it may be a student's work."""
    LEFT_OUT = "left out"
    """A person wrote ``no`` under ``use``."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one file.

    Attributes:
        label: The file's name in messages.
        state: The state of the file.
        reason: Why the file is not at its place, and what to type; empty if it is there.
        student: The student's id; empty if unknown.
        assignment: The assignment's name; empty if unknown.
        when: The time of handing in, in UTC; None if unknown.
        late: True if the LMS marks it as late.
        replaced: True if another file was at its place; that file is kept.
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
        untimed: Students with work collected now whose time of handing in is unknown; by assignment.
        missing: Students who have handed in nothing, by assignment.
        waiting: The number of lines in the table that wait for a person.
        by_their_names: True if there is no list of students, so that folders have the LMS's names.
        notes: Times that were recorded, names in a list that are not students, empty downloads.
    """

    path: Path
    outcomes: tuple[Outcome, ...] = ()
    untimed: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: dict[str, tuple[str, ...]] = field(default_factory=dict)
    waiting: int = 0
    by_their_names: bool = False
    notes: tuple[str, ...] = ()

    def having(self, state: State) -> tuple[Outcome, ...]:
        """The files with this state."""
        return tuple(one for one in self.outcomes if one.state == state)

    @property
    def exit_code(self) -> int:
        """0 when everything has its place; 2 if a line of these files waits for a person."""
        return 2 if self.having(State.NOT_PLACED) else 0
