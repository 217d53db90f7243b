"""Makes the rows of the table of results.

Points come from the gradebook, states and diagnoses from the judge. The points are multiplied by the weights that
``class.toml`` sets for exercises and assignments, and what the file leaves out does not count.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from datetime import UTC, tzinfo
from typing import TYPE_CHECKING

from autograder.grading.classes import class_file
from autograder.grading.grading_errors import GradingError, check_known
from autograder.grading.table.rows import (
    BY_HAND,
    DROPPED,
    EXCUSED,
    LATE,
    NOT_GRADED,
    NOT_SUBMITTED,
    WAITS,
    Row,
    grouped,
    total,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.classes.gradebook_reading import CellEntry, Entries, SubmissionEntry
    from autograder.grading.grading_task import GradedCell
    from autograder.grading.table.roster import Roster

    Judged = Mapping[tuple[str, str], Sequence[Row]]
    """The judge's results for each submission, by student and assignment."""


@dataclass(frozen=True)
class WhatCounts:
    """The weights for a class's table. They may change at any time, because the gradebook's points are without weights.

    Attributes:
        factors: The factors that multiply points, by assignment and exercise; the factor 0 leaves an exercise out.
        drop_lowest: The number of assignments that do not count: for each student, those with the fewest points.
    """

    factors: Mapping[tuple[str, str], float] = field(default_factory=dict)
    drop_lowest: int = 0

    def applied(self, rows: Sequence[Row]) -> list[Row]:
        """Multiply the points in the rows of one submission by the weights, and return the new rows.

        The late penalty remains the same fraction of the points.
        """
        plain = [row for row in rows if row.exercise != LATE]
        factors = [self.factors.get((row.assignment, row.exercise), 1.0) for row in plain]
        earned = sum(row.score for row in plain)
        counted = sum(row.score * factor for row, factor in zip(plain, factors, strict=True))
        late = counted / earned if earned else 0.0
        found = [_scaled(row, factor) for row, factor in zip(plain, factors, strict=True) if factor]
        return found + [_scaled(row, late) for row in rows if row.exercise == LATE and found]

    def without_lowest(self, rows: Sequence[Row]) -> list[Row]:
        """Return the rows of one student, with an added row for each dropped assignment that subtracts its points.

        Assignments without a submission are dropped first, then those with the smallest share of their maximum points.
        But at least one assignment always counts, and no assignment is dropped while points for any assignment are
        still missing.
        """
        by_assignment = grouped(rows, lambda row: row.assignment)
        worth = {name: sum(row.max_score for row in own) for name, own in by_assignment.items()}
        points = {name: total(own) for name, own in by_assignment.items() if worth[name]}
        to_come = any(row.is_to_come and row.max_score for row in rows)
        if to_come or total(rows) is None:
            return list(rows)
        shares = {name: -1.0 if own is None else own / worth[name] for name, own in points.items()}
        for name in sorted(shares, key=shares.__getitem__)[: min(self.drop_lowest, len(shares) - 1)]:
            dropped = Row(
                rows[0].student,
                name,
                DROPPED,
                0.0 - (points[name] or 0.0),
                -worth[name],
                DROPPED,
                reason=f"among the {self.drop_lowest} lowest of {len(shares)} assignments",
                name=rows[0].name,
            )
            by_assignment[name].append(dropped)
        return [row for own in by_assignment.values() for row in own]


def _scaled(row: Row, factor: float) -> Row:
    def times(points: float | None) -> float | None:
        return None if points is None else round(points * factor, 4)

    return replace(
        row,
        score=round(row.score * factor, 4),
        max_score=round(row.max_score * factor, 4),
        judged=times(row.judged),
        by_hand=times(row.by_hand),
        extra=round(row.extra * factor, 4),
    )


def read_what_counts(directory: ClassDirectory, cells: Mapping[str, Sequence[GradedCell]]) -> WhatCounts:
    """Return the settings from ``class.toml``. If the file does not exist, nothing is weighted or left out.

    Args:
        directory: The class.
        cells: The cells with points, by assignment.

    Raises:
        GradingError: The file cannot be used. The message says what to write.
    """
    path, said = directory.path / class_file.NAME, class_file.read_class_file(directory.path)
    exercises = {cell.exercise for of_assignment in cells.values() for cell in of_assignment}
    check_known((*said.leave_out, *said.points), sorted(exercises), f"exercise for {path}")
    check_known((*said.weights, *said.out_of), sorted(cells), f"assignment for {path}")
    for name, points in (*said.points.items(), *said.weights.items(), *said.out_of.items()):
        if not 0 <= points < 1e6:
            raise GradingError(
                f"{path} sets {name} to {points:g}. Write a number from 0 to less than 1000000."
            )
    factors: dict[tuple[str, str], float] = {}
    for assignment, of_assignment in cells.items():
        weight = said.weights.get(assignment, 1.0)
        for cell in of_assignment:
            points = 0.0 if cell.exercise in said.leave_out else said.points.get(cell.exercise, cell.worth)
            factors[assignment, cell.exercise] = weight * points / cell.worth if cell.worth else weight
    return WhatCounts(factors, said.drop_lowest)


def true_rows(
    roster: Roster,
    cells: Mapping[str, Sequence[GradedCell]],
    judged: Judged,
    entries: Entries,
    handed_in: Iterable[tuple[str, str]],
    *,
    what_counts: WhatCounts = WhatCounts(),
    zone: tzinfo = UTC,
) -> list[Row]:
    """Return the rows of a class, sorted by student and then in the order of the course.

    Every student has rows for each assignment that at least one student has handed in.

    Args:
        roster: The students of the class.
        cells: The cells with points, by assignment.
        judged: The judge's results, by student and assignment.
        entries: The entries of the gradebook.
        handed_in: The submissions in ``submitted``, as pairs of a student and an assignment.
        what_counts: The instructor's weights, and the exercises that are left out.
        zone: The time zone of the class.
    """
    there = set(handed_in)
    known = roster.members(student for student, _ in [*there, *entries])
    names, excused = roster.names, roster.excused
    assignments = [name for name in sorted(cells) if any(name == other for _, other in [*there, *entries])]
    found = []
    for student in known:
        rows: list[Row] = []
        for assignment in assignments:
            key, name = (student, assignment), names.get(student, "")
            if key in excused:
                own = [Row(*key, cell.exercise, 0.0, 0.0, EXCUSED, name=name) for cell in cells[assignment]]
            else:
                blank = Row(*key, "", 0.0, 0.0, "", name=name)
                said, entry = judged.get(key, ()), entries.get(key)
                own = _rows_of(blank, cells[assignment], said, entry, zone, is_there=key in there)
            rows += what_counts.applied(own)
        found += what_counts.without_lowest(rows)
    return found


_IS_GRADED = ("passed", "failed", WAITS, BY_HAND)
"""The states of a cell after a finished run. A cell in another state cannot wait for a person."""


def _rows_of(
    blank: Row,
    cells: Sequence[GradedCell],
    judged: Sequence[Row],
    entry: SubmissionEntry | None,
    zone: tzinfo,
    *,
    is_there: bool,
) -> list[Row]:
    by_exercise = {row.exercise: row for row in judged}
    found = []
    for cell in cells:
        row = replace(blank, exercise=cell.exercise, max_score=cell.worth)
        said = by_exercise.get(cell.exercise)
        kept = entry.cells.get(cell.notebook, {}).get(cell.name) if entry else None
        if said is not None:
            row = replace(
                row, state=said.state, diagnosis=said.diagnosis, reason=said.reason, remarks=said.remarks
            )
        elif kept is None:
            row = replace(row, state=NOT_GRADED if is_there else NOT_SUBMITTED)
        else:
            row = replace(row, state=_state(cell, kept))
        if kept is not None:
            row = replace(
                row,
                score=kept.score,
                judged=kept.judged,
                by_hand=kept.by_hand,
                extra=kept.extra,
                waits=kept.waits and row.state in _IS_GRADED,
            )
        found.append(row)
    if entry and entry.taken_off:
        why = entry.why_late(zone)
        found.append(replace(blank, exercise=LATE, score=-entry.taken_off, state=LATE, reason=why))
    return found


def _state(cell: GradedCell, kept: CellEntry) -> str:
    """Return the state of a cell without a stored result of the judge, from the gradebook's entry."""
    if not cell.by_judge:
        if kept.by_hand is None and not kept.waits:
            return "failed"  # the student left the cell empty, so nbgrader gave zero points
        return WAITS if kept.waits else BY_HAND
    if kept.waits and kept.by_hand is None:
        return NOT_GRADED  # the grade was set to zero before a run
    return "passed" if (kept.judged or 0.0) >= kept.max_score else "failed"
