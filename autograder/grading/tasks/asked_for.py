"""Defines the choices of the instructor for a run of ``grade``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.grading.classes.student_folders import RefusedFile


@dataclass(frozen=True)
class AskedFor:
    """The choices of the instructor for a run.

    Attributes:
        assignments: The chosen assignments; all if empty.
        students: The chosen students; all if empty.
        again: True to execute every notebook again.
        feedback: True to make feedback pages.
        dry_run: True to leave the gradebook unchanged.
        lower: ``yes`` to take over points that fell although the same files were handed in, ``no`` to keep the earlier
            points, and empty to ask.
    """

    assignments: Sequence[str]
    students: Sequence[str]
    again: bool = False
    feedback: bool = True
    dry_run: bool = False
    lower: str = ""

    def has(self, student: str, assignment: str) -> bool:
        """Return True if the submission of a student for an assignment is chosen."""
        return (not self.assignments or assignment in self.assignments) and (
            not self.students or student in self.students
        )

    def tells_of(self, refused: RefusedFile, class_folder: Path) -> bool:
        """Return True if a refused file belongs, or may belong, to the chosen students and assignments."""
        submitted = class_folder / "submitted"
        if submitted not in refused.path.parents:
            return True
        parts = refused.path.relative_to(submitted).parts
        return (not self.students or parts[0] in self.students) and (
            not self.assignments or len(parts) < 3 or parts[1] in self.assignments
        )
