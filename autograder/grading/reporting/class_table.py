"""Reads the table of results of a class, without grading any submission."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from autograder.grading.class_store import ClassStore
from autograder.grading.classes.gradebook_reading import Entries, read_entries
from autograder.grading.collecting.collected_csv import Table, Waiting
from autograder.grading.grading_errors import MasterUnusable
from autograder.grading.reporting.gradebook_layouts import LAYOUTS
from autograder.grading.table.roster import Roster, Student
from autograder.grading.table.rows import DROPPED, EXCUSED, NOT_SUBMITTED, Row, grouped, total
from autograder.grading.table.student_list import read_roster
from autograder.grading.table.weighted_rows import read_what_counts, true_rows
from autograder.grading.tasks.result_keys import ResultKeys
from autograder.grading.tasks.source_points import read_released

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from autograder.grading.classes.class_directory import ClassDirectory


@dataclass(frozen=True)
class ClassTable:
    """The table of results of a class.

    Attributes:
        rows: The rows, sorted by student and then in the order of the course.
        roster: The students of the class.
        entries: The entries of the gradebook, by student and assignment.
        stale: Submissions, as student/assignment, that were never graded, or changed after they were graded.
        unplaced: Collected files that belong to no known submission, so that a person has to assign them.
        unusable: Assignments without rows because a source notebook cannot be used, by name, each with the reason.
        notices: Sentences about probable mistakes of the instructor in ``students.csv``. They contain students' ids.
        absent: The points of students who handed in nothing: None for no points, or zero if the instructor chose zero.
    """

    rows: tuple[Row, ...]
    roster: Roster
    entries: Entries
    stale: tuple[str, ...] = ()
    unplaced: tuple[Waiting, ...] = ()
    unusable: Mapping[str, str] = field(default_factory=dict)
    notices: tuple[str, ...] = ()
    absent: float | None = None

    @functools.cached_property
    def _of_student(self) -> dict[str, list[Row]]:
        return grouped(self.rows, lambda row: row.student)

    @functools.cached_property
    def students(self) -> list[str]:
        """The ids of all students in the table."""
        return list(self._of_student)

    @functools.cached_property
    def assignments(self) -> list[str]:
        """The assignments for which at least one student has a submission."""
        return list(dict.fromkeys(row.assignment for row in self.rows))

    def check_usable(self, wanted: Collection[str] = ()) -> None:
        """Raise an error if a wanted assignment cannot be graded, or if no assignment at all can be graded.

        Raises:
            MasterUnusable: A source notebook cannot be used, for the reason in the message.
        """
        for name, reason in self.unusable.items():
            if name in wanted or not self.assignments:
                raise MasterUnusable(reason)

    def of(self, student: str, assignment: str = "") -> list[Row]:
        """Return a student's rows, for one assignment or for all.

        If the result is for all assignments, it also contains a row with negative points for each dropped assignment.
        """
        own = self._of_student.get(student, [])
        return [
            row for row in own if not assignment or (row.assignment == assignment and row.exercise != DROPPED)
        ]

    def only(self, students: Collection[str]) -> ClassTable:
        """Return a copy of the table with only these students."""
        return replace(
            self,
            rows=tuple(row for row in self.rows if row.student in students),
            entries={key: entry for key, entry in self.entries.items() if key[0] in students},
            stale=tuple(key for key in self.stale if key.partition("/")[0] in students),
            unplaced=tuple(one for one in self.unplaced if not one.student or one.student in students),
        )

    def score(self, student: str, assignment: str = "") -> float | None:
        """Return a student's points for an assignment, or for all, after weights and the late penalty.

        The result is ``absent`` if the student handed in nothing. For one assignment, the result is None if a check of
        the assignment could not be made, because the sum of the other points would look like the final points.
        """
        rows = self.of(student, assignment)
        return None if assignment and any(row.is_unchecked for row in rows) else self.points(rows)

    def points(self, rows: Sequence[Row]) -> float | None:
        """Return the sum of the points in some of a student's rows; ``absent`` if the student handed in nothing."""
        is_absent = any(row.state == NOT_SUBMITTED for row in rows) and all(row.is_blank for row in rows)
        return self.absent if is_absent else total(rows)

    def has_points(self, student: str, assignments: Iterable[str]) -> bool:
        """Return True if the student has points for one of these assignments, or is excused from one."""
        return any(
            self.score(student, name) is not None or self.is_excused(student, name) for name in assignments
        )

    def is_excused(self, student: str, assignment: str) -> bool:
        """Return True if the student is excused from the assignment."""
        return any(row.state == EXCUSED for row in self.of(student, assignment))

    def max_score(self, assignment: str = "") -> float:
        """Return the maximum points for an assignment, or for all assignments together."""
        return self._max_scores.get(assignment, 0.0)

    @functools.cached_property
    def _max_scores(self) -> dict[str, float]:
        """The maximum points by assignment, and under the key ``""`` those of all assignments together."""
        return {
            name: max(
                (sum(row.max_score for row in self.of(one, name)) for one in self.students), default=0.0
            )
            for name in ("", *self.assignments)
        }

    def late_notices(self, systems: Iterable[str]) -> list[str]:
        """Return sentences about late penalties that one of these systems may subtract once more."""
        is_late = any(entry.is_late or entry.penalty for entry in self.entries.values())
        layouts = [LAYOUTS[name] for name in sorted(systems) if name in LAYOUTS and is_late]
        return [layout.late_twice for layout in layouts if layout.late_twice]

    @property
    def waiting(self) -> list[Row]:
        """The rows that a person still has to grade."""
        return [row for row in self.rows if row.waits]


def read_table(directory: ClassDirectory, sections: Sequence[str] = ()) -> ClassTable:
    """Read the current table of a class.

    Args:
        directory: The class.
        sections: The sections whose students are in the table; all students if empty.

    Raises:
        GradingError: The class or its list of students cannot be used, or a section has no students.
    """
    keys = ResultKeys(directory)
    with ClassStore(directory) as store:
        entered = store.entered()
        released = read_released(directory, store, keys)
    cells = released.cells
    entries = read_entries(directory.gradebook_url)
    found = {one.key: one for one in directory.submissions()[0]}
    judged: dict[tuple[str, str], tuple[Row, ...]] = {}
    stale = []
    for key in sorted({*found, *entries}):
        submission = found.get(key)
        known = entered.get(key)
        if known is not None:
            judged[key] = known.rows
        if submission is not None and (known is None or known.made_from != keys.of(submission)):
            stale.append("/".join(key))
    roster = read_roster(directory)
    what_counts = read_what_counts(directory, cells)
    rows = true_rows(roster, cells, judged, entries, found, what_counts=what_counts, zone=directory.time_zone)
    unplaced = tuple(Table(directory).waiting())
    others = [Student(row.student) for row in rows if row.student not in roster.students]
    whole = Roster([*roster.students.values(), *others])
    table = ClassTable(tuple(rows), whole, entries, tuple(stale), unplaced, released.unusable)
    shown = table.only(roster.of_sections(sections)) if sections else table
    systems = {lms for student in roster.students.values() for lms in student.lms}
    notices = [
        *roster.notices(directory.assignments(), entries, shown.students),
        *shown.late_notices(systems),
        *roster.left_out(sections),
    ]
    return replace(shown, notices=tuple(notices))


@dataclass(frozen=True)
class Difference:
    """A change of a student's points or diagnosis in one exercise.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        exercise: The exercise's id, or ``late``.
        before: The points before; None if there were none.
        after: The points after; None if there are none.
        diagnosis_before: The diagnosis before.
        diagnosis_after: The diagnosis now.
        note: A remark for the instructor; empty if there is none.
    """

    student: str
    assignment: str
    exercise: str
    before: float | None
    after: float | None
    diagnosis_before: str = ""
    diagnosis_after: str = ""
    note: str = ""

    def line(self) -> str:
        """Return the difference as a line of text."""
        points = " → ".join("–" if points is None else f"{points:g}" for points in (self.before, self.after))
        words = ""
        if self.before is None and self.diagnosis_after:
            words = f" ({self.diagnosis_after})"
        elif self.diagnosis_before != self.diagnosis_after:
            words = f" ({self.diagnosis_before or 'no mistake'} → {self.diagnosis_after or 'no mistake'})"
        return f"{self.student}  {self.exercise}  {points}{words}{f', {self.note}' if self.note else ''}"
