"""Reads from ``class.toml`` the weights of exercises and assignments, and which of them do not count."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated

import msgspec

from autograder.grading.errors import GradingError
from autograder.grading.reporting.rows import DROPPED, LATE, Row, total

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.rebuilding.source_points import GradedCell

NAME = "class.toml"


class _File(msgspec.Struct, forbid_unknown_fields=True):
    leave_out: list[str] = []
    points: dict[str, float] = {}
    weights: dict[str, float] = {}
    drop_lowest: Annotated[int, msgspec.Meta(ge=0)] = 0


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
        by_assignment: dict[str, list[Row]] = {}
        for row in rows:
            by_assignment.setdefault(row.assignment, []).append(row)
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
    path = directory.path / NAME
    if not path.exists():
        return WhatCounts()
    try:
        said = msgspec.convert(tomllib.loads(path.read_text(encoding="utf-8-sig")), type=_File)
    except (OSError, ValueError) as error:
        raise GradingError(
            f'{path} cannot be used: {error}. It may contain leave_out = ["EXERCISE"], drop_lowest = 1, '
            "and tables named points and weights."
        ) from error
    exercises = {cell.exercise for of_assignment in cells.values() for cell in of_assignment}
    for name, known in (
        *((name, exercises) for name in (*said.leave_out, *said.points)),
        *((name, cells.keys()) for name in said.weights),
    ):
        if name not in known:
            raise GradingError(
                f"{path} contains {name}, which does not exist in this class. Possible names are: "
                f"{', '.join(sorted(known))}."
            )
    for name, points in (*said.points.items(), *said.weights.items()):
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
