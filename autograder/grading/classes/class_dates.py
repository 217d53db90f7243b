"""The due dates and extensions of a class, in UTC as in the gradebook."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from datetime import datetime


@dataclass(frozen=True)
class ClassDates:
    """The dates of a class.

    Attributes:
        due: The due dates by assignment, in UTC without a zone; None for an assignment that has none.
        extended: The later dates of students, by student and assignment.
    """

    due: Mapping[str, datetime | None] = field(default_factory=dict)
    extended: Mapping[tuple[str, str], datetime] = field(default_factory=dict)

    def of(self, student: str, assignment: str, otherwise: datetime | None) -> datetime | None:
        """Return the date at which the work of a student is due.

        Args:
            otherwise: The date that counts if ``class.toml`` does not name the assignment.
        """
        if assignment not in self.due:
            return otherwise
        return self.extended.get((student, assignment), self.due[assignment])
