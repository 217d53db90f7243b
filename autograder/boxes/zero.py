"""The verdict where the judge has none: zero points, and a reason a student can act on."""

from __future__ import annotations

import re

from autograder.boxes.execution import CellRun, Check, Ended
from autograder.verdict import Diagnosis, State, Verdict, not_checked

_SYNTAX_ERRORS = ("SyntaxError", "IndentationError", "TabError")


def zero(check: Check, key: str, reason: str, next_step: str, detail: str = "") -> Verdict:
    """A failed check without criteria.

    Args:
        check: The check that was to be made.
        key: The diagnosis.
        reason: What happened, for the student.
        next_step: What to do now.
        detail: More text, such as the end of a traceback.
    """
    return Verdict(
        exercise=check.exercise,
        title=check.title,
        state=State.FAILED,
        score=0.0,
        max_score=check.points,
        diagnosis=Diagnosis(key=key, text=reason, next_step=next_step),
        detail=detail,
    )


def grader_trouble(check: Check, reason: str) -> Verdict:
    """The grader's own trouble: nobody's fault who submitted, and worth another run."""
    return not_checked(
        check.exercise,
        check.title,
        check.points,
        f"This could not be checked: {reason}",
        "This is the grader's trouble, not yours. It is tried again at the next grading run.",
    )


def without_verdict(check: Check, run: CellRun, before: list[tuple[str, CellRun]], limit: float) -> Verdict:
    """Why a check cell has no verdict.

    Args:
        check: The check that was to be made.
        run: What came of the check cell.
        before: The cells since the last check, each with its first line, in order.
        limit: Seconds of wall time that the check cell had.
    """
    match run.ended:
        case Ended.NOT_RUN | Ended.KERNEL_DIED:
            return _kernel_gone(check, run, before)
        case Ended.TIMED_OUT:
            return zero(
                check,
                "cell_timed_out",
                f"The check cell was stopped after {limit:g} s, before the judge had seen enough.",
                "Look for a call that waits without a limit or a loop that never ends.",
            )
        case Ended.RAISED:
            return _stopped_by_error(check, run, before)
        case Ended.DONE:
            return zero(
                check,
                "not_asked",
                "The check cell ran, but the check that belongs to it was never made.",
                "Make sure that no cell of yours redefines `check`.",
            )


def _kernel_gone(check: Check, run: CellRun, before: list[tuple[str, CellRun]]) -> Verdict:
    if run.ended is Ended.KERNEL_DIED:
        place = "while this check cell was running"
    else:
        culprit = next((title for title, cell in before if cell.ended is Ended.KERNEL_DIED), "")
        if not culprit:
            return _out_of_time(check, before)
        place = f"in the cell that begins with “{culprit}”, before this check cell had its turn"
    return zero(
        check,
        "kernel_died",
        f"The notebook's kernel ended {place}.",
        "Look for `exit()`, `quit()` or `os._exit()`, or for something that makes Python crash. "
        "Restart the kernel and run all cells: that is what the grader does.",
    )


def _out_of_time(check: Check, before: list[tuple[str, CellRun]]) -> Verdict:
    slow = [title for title, cell in before if cell.ended is Ended.TIMED_OUT]
    reason = "The notebook's time was up before this check cell had its turn."
    if slow:
        reason = (
            f"The cell that begins with “{slow[-1]}” did not end at its time limit, nor when interrupted."
        )
    return zero(
        check,
        "notebook_timed_out",
        reason,
        "Look for a loop that never ends. Restart the kernel and run all cells: each must come to its end.",
    )


def _stopped_by_error(check: Check, run: CellRun, before: list[tuple[str, CellRun]]) -> Verdict:
    """The cell raised, mostly because what it names was never defined: the cause is in an earlier cell."""
    title, cause = next(
        ((title, cell) for title, cell in before if cell.ended in (Ended.RAISED, Ended.TIMED_OUT)), ("", None)
    )
    if cause is not None and cause.ended is Ended.TIMED_OUT:
        return zero(
            check,
            "cell_timed_out",
            f"The cell that begins with “{title}” was stopped at its time limit, so no check could begin.",
            "Look for a loop that never ends. To keep a node running, spin it in the background.",
        )
    first = cause or run
    reason = f"The check could not begin: {_told(run.error)}."
    if cause:
        reason = (
            f"The cell that begins with “{title}” ended with {_told(cause.error)}, "
            "so the check could not begin."
        )
    return zero(
        check,
        "syntax_error" if first.error.startswith(_SYNTAX_ERRORS) else "crashed",
        reason,
        "Mend the first cell that shows an error, then restart the kernel and run all cells.",
        detail=_end_of_traceback(first),
    )


def _told(error: str) -> str:
    """An error's words without the name that IPython gives to the file of a cell."""
    return re.sub(r"\(\d+\.py, line (\d+)\)", r"(line \1)", error).strip().rstrip(":.")


def _end_of_traceback(run: CellRun) -> str:
    for output in run.outputs:
        if output["output_type"] == "error":
            return "\n".join(output["traceback"])[-2000:]
    return ""
