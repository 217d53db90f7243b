"""The choice of what is graded: the assignments and the students that were named, or all where none was."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.grading.classes.class_directory import Refused


@dataclass(frozen=True)
class AskedFor:
    """The choice of what a run is to grade.

    Attributes:
        assignments: Only these; all where there is none.
        students: Only these; all where there is none.
    """

    assignments: Sequence[str]
    students: Sequence[str]

    def has(self, student: str, assignment: str) -> bool:
        """True if a student's work for an assignment was asked for."""
        return (not self.assignments or assignment in self.assignments) and (
            not self.students or student in self.students
        )

    def tells_of(self, refused: Refused, class_folder: Path) -> bool:
        """True if what was refused belongs to the students and assignments that were named."""
        submitted = class_folder / "submitted"
        if not refused.path.is_relative_to(submitted):
            return True
        parts = refused.path.relative_to(submitted).parts
        return (not self.students or parts[0] in self.students) and (
            not self.assignments or len(parts) < 3 or parts[1] in self.assignments
        )


def check_known(wanted: Sequence[str], known: Sequence[str], what: str) -> None:
    """See that there is what was asked for by name.

    Raises:
        GradingError: There is not; the message says what there is.
    """
    for name in wanted:
        if name not in known:
            raise GradingError(
                f"There is no {what} named {name} here. There is: {', '.join(known) or 'none'}."
            )
