"""Makes the rows of the table of results: points come from the gradebook, states and diagnoses from the judge."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, tzinfo
from typing import TYPE_CHECKING

from autograder.grading.reporting.rows import BY_HAND, EXCUSED, LATE, NOT_GRADED, NOT_SUBMITTED, WAITS, Row
from autograder.grading.table.what_counts import WhatCounts

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from autograder.grading.gradebooks.gradebook_reading import CellEntry, Entries, SubmissionEntry
    from autograder.grading.rebuilding.source_points import GradedCell

    Judged = Mapping[tuple[str, str], Sequence[Row]]
    """The judge's results for each submission, by student and assignment."""


def true_rows(
    students: Mapping[str, str],
    cells: Mapping[str, Sequence[GradedCell]],
    judged: Judged,
    entries: Entries,
    handed_in: Iterable[tuple[str, str]],
    *,
    excused: Collection[tuple[str, str]] = (),
    what_counts: WhatCounts = WhatCounts(),  # noqa: B008 (it is frozen)
    zone: tzinfo = UTC,
) -> list[Row]:
    """Return the rows of a class, sorted by student and then in the order of the course.

    Every student has rows for each assignment that at least one student has handed in.

    Args:
        students: The names of the students, by id.
        cells: The cells with points, by assignment.
        judged: The judge's results, by student and assignment.
        entries: The entries of the gradebook.
        handed_in: The submissions in ``submitted``, as pairs of a student and an assignment.
        excused: Pairs of a student and an assignment from which the student is excused.
        what_counts: The instructor's weights, and the exercises that are left out.
        zone: The time zone of the class.
    """
    there = set(handed_in)
    known = sorted({student for student, _ in [*there, *entries]} | students.keys())
    assignments = [name for name in sorted(cells) if any(name == other for _, other in [*there, *entries])]
    found = []
    for student in known:
        rows: list[Row] = []
        for assignment in assignments:
            key, name = (student, assignment), students.get(student, "")
            if key in excused:
                own = [Row(*key, cell.exercise, 0.0, 0.0, EXCUSED, name=name) for cell in cells[assignment]]
            else:
                blank = Row(*key, "", 0.0, 0.0, "", name=name)
                said, entry = judged.get(key, ()), entries.get(key)
                own = _rows_of(blank, cells[assignment], said, entry, zone, is_there=key in there)
            rows += what_counts.applied(own)
        found += what_counts.without_lowest(rows)
    return found


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
        found.append(row if kept is None else _with_points(row, kept))
    if entry and entry.taken_off:
        why = entry.why_late(zone)
        found.append(replace(blank, exercise=LATE, score=-entry.taken_off, state=LATE, reason=why))
    return found


def _with_points(row: Row, kept: CellEntry) -> Row:
    return replace(
        row,
        score=kept.score,
        judged=kept.judged,
        by_hand=kept.by_hand,
        extra=kept.extra,
        waits=kept.waits and row.state in _IS_GRADED,
    )


_IS_GRADED = ("passed", "failed", WAITS, BY_HAND)
"""The states of a cell after a finished run. A cell in another state cannot wait for a person."""


def _state(cell: GradedCell, kept: CellEntry) -> str:
    """Return the state of a cell without a stored result of the judge, from the gradebook's entry."""
    if not cell.by_judge:
        if kept.by_hand is None and not kept.waits:
            return "failed"  # the student left the cell empty, so nbgrader gave zero points
        return WAITS if kept.waits else BY_HAND
    if kept.waits and kept.by_hand is None:
        return NOT_GRADED  # the grade was set to zero before a run
    return "passed" if (kept.judged or 0.0) >= kept.max_score else "failed"
