"""The late penalty: a percentage of the points for each started day, with a grace period and a cut-off.

A class sets these three values in its ``nbgrader_config.py``, from where nbgrader's own commands use them as well.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nbgrader.plugins import LateSubmissionPlugin
from nbgrader.preprocessors import AssignLatePenalties
from traitlets import Float

if TYPE_CHECKING:
    from traitlets.config import Config

    from autograder.grading.classes.gradebook_reading import SubmissionEntry

_DAY = 86_400.0


class LatePolicy(LateSubmissionPlugin):
    """nbgrader's plugin for late penalties: subtracts a percentage of the points for each day late."""

    percent_per_day = Float(
        10.0,
        min=0,
        max=100,
        help="The percentage of the points to subtract for each day late. A started day counts as a whole day.",
    ).tag(config=True)
    grace_minutes = Float(
        0.0, min=0, help="A submission that is at most this many minutes late loses no points."
    ).tag(config=True)
    cut_off_days = Float(
        math.inf, min=0, help="A submission that is more than this many days late earns no points."
    ).tag(config=True)

    def late_submission_penalty(self, student_id: str, score: float, total_seconds_late: float) -> float:
        """Return the points to subtract for a late notebook.

        Args:
            student_id: The student's id.
            score: The points that were earned.
            total_seconds_late: The number of seconds after the due date, which an extension has already moved.
        """
        del student_id  # unused: the due date already includes the student's extension
        if total_seconds_late <= 60 * self.grace_minutes:
            return 0.0
        if total_seconds_late > _DAY * self.cut_off_days:
            return score
        days = math.ceil(total_seconds_late / _DAY)
        return round(min(1.0, days * self.percent_per_day / 100) * score, 4)


def penalties(config: Config, student: str, entry: SubmissionEntry) -> dict[str, float | None]:
    """Return the late penalty of each notebook of a submission, as nbgrader computes it; None for no penalty.

    Args:
        config: The class's configuration.
        student: The student's id.
        entry: The points and times of the submission, for example from the gradebook.
    """
    if not (entry.handed_in and entry.due and entry.is_late):
        return dict.fromkeys(entry.cells)
    asking = AssignLatePenalties(config=config)
    asking.init_plugin()
    late = (entry.handed_in - entry.due).total_seconds()
    found: dict[str, float | None] = {}
    for notebook, cells in entry.cells.items():
        score = sum(cell.score for cell in cells.values())
        costs = asking.plugin_inst.late_submission_penalty(student, score, late)
        found[notebook] = None if costs is None else min(max(0.0, costs), score)
    return found
