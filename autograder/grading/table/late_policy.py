"""The price of being late, as data: a share of the points for each day that has begun, a grace, a cut-off.

A class names it in its ``nbgrader_config.py``; nbgrader asks it, whichever command or button grades.
"""

from __future__ import annotations

import math

from nbgrader.plugins import LateSubmissionPlugin
from traitlets import Float

_DAY = 86_400.0


class LatePolicy(LateSubmissionPlugin):
    """A share of the points for each day."""

    percent_per_day = Float(
        10.0, min=0, max=100, help="Taken off for each day that has begun, in percent."
    ).tag(config=True)
    grace_minutes = Float(0.0, min=0, help="Who is late by no more than this loses nothing.").tag(config=True)
    cut_off_days = Float(
        math.inf, min=0, help="Who is late by more days than this has no points for the assignment."
    ).tag(config=True)

    def late_submission_penalty(self, student_id: str, score: float, total_seconds_late: float) -> float:
        """The points to be taken off.

        Args:
            student_id: The student's id.
            score: Points that were earned.
            total_seconds_late: Seconds after the due date, extensions included.
        """
        del student_id  # who has an extension has another due date
        if total_seconds_late <= 60 * self.grace_minutes:
            return 0.0
        if total_seconds_late > _DAY * self.cut_off_days:
            return score
        days = math.ceil(total_seconds_late / _DAY)
        return round(min(1.0, days * self.percent_per_day / 100) * score, 4)
