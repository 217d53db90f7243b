"""The points of a cell of plain tests: the rules of nbgrader, where no judge looks.

Such a cell runs in the student's own kernel, so whoever wants to can have it say anything; a check of the judge's in
the same notebook is not touched by that. One rule is not nbgrader's: a line on standard error costs nothing, because
ROS and many libraries log there when all is well.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.boxes.execution import CellRun, Check, Ended
from autograder.verdict import Diagnosis, State, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import Any

_ASSERTION = "AssertionError"
_STUB = "NotImplementedError"
"""Raised by what nbgrader puts in the place of a solution."""


def verdict_of(check: Check, run: CellRun) -> Verdict | None:
    """The verdict on a cell of plain tests.

    Args:
        check: The cell's; its points are those of the gradebook.
        run: What came of it.

    Returns:
        None for a cell that did not come to its end for another reason than a failing test.
    """
    if run.ended is Ended.RAISED and run.error.startswith(_ASSERTION):
        said = run.error.removeprefix(_ASSERTION).lstrip(": ").strip()
        text = f"A test of this cell does not hold: {said}" if said else "A test of this cell does not hold."
        step = "Read the line with the arrow in the output: it says which test it was."
        return _verdict(check, 0.0, Diagnosis("assertion_failed", text, step))
    if run.ended is Ended.RAISED and run.error.startswith(_STUB):
        text = "What this cell tests is not solved yet."
        step = "Write your answer in the place of the line `raise NotImplementedError()`."
        return _verdict(check, 0.0, Diagnosis("not_written", text, step))
    if run.ended is not Ended.DONE:
        return None
    score = min(check.points, _partial_credit(run.outputs, check.points))
    if score < check.points:
        text = f"The tests of this cell give {score:g} of {check.points:g} points."
        return _verdict(check, score, Diagnosis("partial_credit", text))
    return _verdict(check, score, None)


def _partial_credit(outputs: Iterable[Mapping[str, Any]], most: float) -> float:
    """The value of the cell where it is a number of points; else all of them."""
    values = [one["data"].get("text/plain", "") for one in outputs if one["output_type"] == "execute_result"]
    try:
        score = float(values[0]) if values else most
    except ValueError:
        return most
    return score if score >= 0 else most


def _verdict(check: Check, score: float, diagnosis: Diagnosis | None) -> Verdict:
    state = State.FAILED if diagnosis else State.PASSED
    return Verdict(check.exercise, check.title, state, score, check.points, diagnosis=diagnosis)
