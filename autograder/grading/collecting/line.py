"""A line of ``collected.csv``: one file, with everything known about it and the decision about it."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime  # noqa: TC003  (msgspec reads the annotations)
from enum import StrEnum

from autograder.grading.collecting.inbox import BY_HAND

Place = tuple[str, str, str]
"""The place of a notebook in ``submitted``: the student's id, and the names of the assignment and the notebook."""


class LineState(StrEnum):
    """The state of a file after collecting. Each file has exactly one state."""

    PLACED = "placed"
    """The file is graded, and is in ``submitted``. In a report, the state also means that this command has written the
    file.
    """
    UNCHANGED = "unchanged"
    """Another file with the same bytes is graded. In a report, the state may also mean that the file itself is graded,
    and was in ``submitted`` before this command.
    """
    EARLIER = "earlier"
    """Another file is graded, so this file is kept as an earlier attempt."""
    BESIDE = "beside"
    """The file is not a notebook to collect, and needs no decision: its student has also handed in a notebook, or the
    LMS made the file.
    """
    NOT_PLACED = "not placed"
    """The file waits for a person, because it may be a student's work."""
    LEFT_OUT = "left out"
    """A person wrote ``no`` under ``use``."""


@dataclass(frozen=True)
class Line:
    """A line of ``collected.csv``.

    Attributes:
        key: The key that identifies the line in ``collected.csv``.
        label: The name of the file in messages.
        content: The hash of the file's bytes.
        students: The ids of the students to whom the file belongs; empty if they are unknown.
        assignment: The name of the assignment; empty if it is unknown.
        notebook: The name of the notebook; empty if it is unknown, or if the file is not a notebook.
        when: The time of handing in, in UTC; in a report, in the time zone of the class.
        order: A number that increases with later files of one student, if the system numbers files.
        late: True if the system marks the file as late.
        use: ``yes`` or ``no``, as a person wrote it; empty if no person did.
        state: The decision about the file.
        reason: Why the file is not graded, and what to do.
        is_soft: True if the file, such as a picture, needs no attention once a notebook of its student was collected.
        lms, number, name, file: The system, and the student and the file as the system calls them. Feedback for the
            system uses these names.
        is_named: True if the file has the name of the notebook.
        is_sure: True if a number of the system identifies the student, not just a name that students may choose.
        came_in: The downloads that contained the file.
        rank: If a file came several times, the line with the lowest rank is preferred. The rank is lower if the command
            named the system, and higher if the command named the assignment.
    """

    key: str
    label: str
    content: str = ""
    students: tuple[str, ...] = ()
    assignment: str = ""
    notebook: str = ""
    when: datetime | None = None
    order: int = 0
    late: bool = False
    use: str = ""
    state: LineState = LineState.NOT_PLACED
    reason: str = ""
    is_soft: bool = False
    lms: str = ""
    number: str = ""
    name: str = ""
    file: str = ""
    is_named: bool = False
    is_sure: bool = False
    came_in: frozenset[str] = field(default_factory=frozenset)
    rank: int = 0

    @property
    def student(self) -> str:
        """The id of the student; empty if it is unknown, or if the file belongs to several."""
        return self.students[0] if len(self.students) == 1 else ""

    @property
    def place(self) -> Place:
        """The student, the assignment and the notebook for which the file was handed in."""
        return self.student, self.assignment, self.notebook

    @property
    def is_by_hand(self) -> bool:
        """True if a person put the file into ``submitted``."""
        return self.lms == BY_HAND
