"""What of a student's points goes into the total."""

from __future__ import annotations

import pytest

from autograder.grading.table.rows import DROPPED, NOT_SUBMITTED, WAITS, Row
from autograder.grading.table.weighted_rows import WhatCounts


@pytest.mark.parametrize(
    ("state", "dropped"), [("failed", True), (NOT_SUBMITTED, True), (WAITS, False), ("not_checked", False)]
)
def test_no_assignment_is_dropped_while_points_are_still_to_come(state: str, dropped: bool) -> None:
    rows = [Row("ada", "lab_1", "lab_1.a", 8, 10, "failed"), Row("ada", "lab_2", "lab_2.a", 0, 10, state)]
    counted = WhatCounts(drop_lowest=1).without_lowest(rows)
    assert any(row.exercise == DROPPED for row in counted) is dropped
