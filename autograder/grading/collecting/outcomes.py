"""The result of collecting, for a person or as JSON."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.grading.collecting.line import LineState

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.grading.collecting.line import Line


@dataclass(frozen=True)
class CollectReport:
    """The result of collecting.

    Attributes:
        path: The class.
        outcomes: The lines of the files that this command named, and other lines that changed.
        untimed: The students with work collected now whose time of handing in is unknown, by assignment.
        missing: The students who have handed in nothing, by assignment.
        waiting: The number of lines in the table that wait for a person.
        notes: Sentences for the instructor, for example about unclear cells and empty downloads.
    """

    path: Path
    outcomes: tuple[Line, ...] = ()
    untimed: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: dict[str, tuple[str, ...]] = field(default_factory=dict)
    waiting: int = 0
    notes: tuple[str, ...] = ()

    def having(self, state: LineState) -> tuple[Line, ...]:
        """Return the lines with this state."""
        return tuple(one for one in self.outcomes if one.state == state)

    @property
    def exit_code(self) -> int:
        """The command's exit code: 2 if a person has to decide about one of the files; otherwise 0."""
        return 2 if self.having(LineState.NOT_PLACED) else 0
