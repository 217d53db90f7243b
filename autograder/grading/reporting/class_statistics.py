"""Statistics of a class, computed from its table of results."""

from __future__ import annotations

import statistics
from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from autograder.grading.table.rows import EXCUSED, LATE, NOT_SUBMITTED, columns, grouped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.grading.class_store import ClassStore
    from autograder.grading.reporting.class_table import ClassTable
    from autograder.grading.table.rows import Row


_ABSENT = (NOT_SUBMITTED, EXCUSED)


def handed_in(table: ClassTable) -> list[str]:
    """Return the ids of the students with at least one submission."""
    return [
        student
        for student in table.students
        if any(row.state not in _ABSENT and row.exercise != LATE for row in table.of(student))
    ]


def totals(table: ClassTable) -> dict[str, float]:
    """Return the total points of each student who has points, by the student's id."""
    return {student: points for student in handed_in(table) if (points := table.score(student)) is not None}


_BANDS = 10


@dataclass(frozen=True)
class Band:
    """One of ten equal ranges of points, with the students in it.

    Attributes:
        low: The lower end in percent of the points.
        high: The upper end in percent. Only the last band includes its upper end.
        students: The ids of the students in the band.
    """

    low: int
    high: int
    students: tuple[str, ...]


def bands(table: ClassTable) -> list[Band]:
    """Return the distribution of total points in ten bands, without students who have no points."""
    found: dict[int, list[str]] = defaultdict(list)
    for student, points in totals(table).items():
        # Work that a student has not handed in does not count as zero here, as in the total.
        most = sum(row.max_score for row in table.of(student) if row.state != NOT_SUBMITTED)
        share = points / most if most else 0.0
        found[max(0, min(_BANDS - 1, int(share * _BANDS + 1e-9)))].append(student)
    width = 100 // _BANDS
    return [Band(place * width, (place + 1) * width, tuple(found[place])) for place in range(_BANDS)]


@dataclass(frozen=True)
class _CriterionFigures:
    """How many submissions meet one criterion.

    Attributes:
        title: The criterion's title.
        passed: The number of submissions that meet the criterion.
        of: The number of submissions in which the criterion was judged.
    """

    title: str
    passed: int
    of: int


@dataclass(frozen=True)
class ItemFigures:
    """The statistics of one exercise, over the students who handed it in.

    Attributes:
        exercise: The exercise's id. If several assignments have a cell with this name, the id follows the assignment's
            name, such as ``lab_1.talker``.
        handed_in: The number of students who have handed it in.
        mean: The mean of these students' points.
        full: The number of these students with full points.
        none: The number of these students without points.
        difficulty: The mean divided by the maximum points, so a high value means an easy exercise.
        discrimination: Pearson's correlation, from -1 to 1, between students' points for this exercise and their
            points for all other exercises; None if it cannot be computed.
        criteria: How many submissions meet each criterion of the exercise.
    """

    exercise: str
    max_score: float
    handed_in: int
    mean: float
    full: int
    none: int
    difficulty: float
    discrimination: float | None
    criteria: tuple[_CriterionFigures, ...] = ()


def items(table: ClassTable, store: ClassStore) -> list[ItemFigures]:
    """Return the statistics of each exercise.

    Args:
        table: The table of the class.
        store: The store of the class, which contains the judge's verdicts.
    """
    criteria = _criteria(table, store)
    found = []
    for key, name in columns(table.rows).items():
        rows = [row for row in table.rows if _key(row) == key and not row.is_blank]
        if not rows:
            continue
        scores, most = [row.score for row in rows], rows[0].max_score
        mean = statistics.fmean(scores)
        others = [sum(row.score for row in table.of(one.student) if _key(row) != key) for one in rows]
        found.append(
            ItemFigures(
                name,
                most,
                len(rows),
                mean,
                sum(score >= most for score in scores),
                sum(score <= 0 for score in scores),
                mean / most if most else 0.0,
                _correlation(scores, others),
                tuple(criteria.get(key, ())),
            )
        )
    return found


def _key(row: Row) -> tuple[str, str]:
    return row.assignment, row.exercise


_FEWEST = 3
"""The minimum number of students for a meaningful correlation."""


def _correlation(ours: Sequence[float], others: Sequence[float]) -> float | None:
    if len(ours) < _FEWEST or len(set(ours)) == 1 or len(set(others)) == 1:
        return None
    return statistics.correlation(ours, others)


def _criteria(table: ClassTable, store: ClassStore) -> dict[tuple[str, str], list[_CriterionFigures]]:
    """Return, for each exercise, how many of the graded submissions meet each criterion."""
    counted = {(row.student, row.assignment) for row in table.rows if row.state in ("passed", "failed")}
    seen: dict[tuple[str, str], dict[str, _CriterionFigures]] = defaultdict(dict)
    for student, assignment in sorted(counted):
        for execution in store.results(student, assignment).values():
            for verdict in execution.verdicts.values():
                of_exercise = seen[assignment, verdict.exercise]
                for criterion in verdict.criteria:
                    known = of_exercise.get(criterion.name, _CriterionFigures(criterion.title, 0, 0))
                    of_exercise[criterion.name] = replace(
                        known, passed=known.passed + bool(criterion.passed), of=known.of + 1
                    )
    return {key: list(figures.values()) for key, figures in seen.items()}


@dataclass(frozen=True)
class MistakeFigures:
    """A mistake that was recognized, with the students who made it.

    Attributes:
        assignment: The assignment's name.
        exercise: The exercise's id.
        key: The mistake's key.
        reason: The explanation in the diagnosis, as one of the students got it.
        students: The ids of the students who made the mistake.
    """

    assignment: str
    exercise: str
    key: str
    reason: str
    students: tuple[str, ...]


def mistakes(table: ClassTable) -> list[MistakeFigures]:
    """Return the recognized mistakes with the students who made them, the most common mistake first."""
    diagnosed = [row for row in table.rows if row.diagnosis]
    found = grouped(diagnosed, lambda row: (row.assignment, row.exercise, row.diagnosis))
    names = columns(table.rows)
    figures = [
        MistakeFigures(
            assignment, names[assignment, exercise], key, rows[0].reason, tuple(row.student for row in rows)
        )
        for (assignment, exercise, key), rows in found.items()
    ]
    return sorted(figures, key=lambda one: (-len(one.students), one.exercise, one.key))
