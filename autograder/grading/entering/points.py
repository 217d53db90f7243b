"""From a verdict to the points in the gradebook."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.boxes.execution import Check, Execution
    from autograder.grading.task import Task
    from autograder.verdict import Verdict


def points(check: Check, verdict: Verdict) -> float:
    """The points that a verdict is worth: the judge's share of what the cell carries."""
    share = verdict.score / verdict.max_score if verdict.max_score > 0 else 0.0
    return round(min(1.0, max(0.0, share)) * check.worth, 4)


def scores_of(task: Task, execution: Execution) -> dict[str, float]:
    """The points of each check cell of a task, by grade_id."""
    return {
        cell.name: points(cell.check, execution.verdicts[index])
        for index, cell in enumerate(task.cells)
        if cell.check is not None
    }
