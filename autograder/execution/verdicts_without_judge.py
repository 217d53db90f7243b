"""Gives verdicts on check cells without the judge: from plain tests, or zero points with a reason and advice.

A cell of plain tests follows nbgrader's rules. It runs in the student's own kernel, so a student can make it print
anything, but the judge's checks in the same notebook are not affected. One rule differs from nbgrader: a line on
standard error costs nothing, because ROS and many libraries log there when nothing is wrong.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import re2

from autograder.boxes.run_limits import Ended
from autograder.verdict import ASKS_FOR_INPUT, Diagnosis, State, Verdict, failed, not_checked

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from autograder.execution.executed_cells import CellCheck, CellRun

_SYNTAX_ERRORS = ("SyntaxError", "IndentationError", "TabError")
_ASSERTION = "AssertionError"
_NO_INPUT = "StdinNotImplementedError"
"""The error that ``input()`` raises in a kernel that has no user."""
_STUB = "NotImplementedError"
"""The error that nbgrader's stub for a removed solution raises."""

LIMITS = {
    Ended.OUT_OF_MEMORY: (
        "used more memory than it is allowed",
        "Look for a list that grows in every call, or for a loop that makes something new each time.",
    ),
    Ended.OUT_OF_CPU: (
        "used more processor time than it is allowed",
        "Look for a loop that never waits: a node that spins needs no loop of its own around it.",
    ),
    Ended.TOO_MANY_PROCESSES: (
        "started more processes and threads than it is allowed",
        "Look for a loop, or for a callback, that starts a thread, an executor or a program each time.",
    ),
    Ended.TOO_MANY_FILES: (
        "had more files and connections open at once than all its programs together are allowed",
        "Close what you open: `with open(…) as file:` does it by itself.",
    ),
    Ended.TOO_MANY_LOCKS: (
        "locked more parts of files at once than all its programs together are allowed",
        "Look for a loop that locks without unlocking, or lock a whole file instead of many parts of it.",
    ),
    Ended.TOO_MUCH_OUTPUT: (
        "printed far more than anyone can read",
        "Look for a loop that prints without waiting, or print less.",
    ),
}
"""Maps each limit of a box to the message for the student, and the advice."""
_SHORTAGES = {
    "OSError: [Errno 28]": (
        "disk_full",
        "filled all the space that it has for files",
        "Look for a file that grows, or for a loop that makes files.",
    ),
    "OSError: [Errno 24]": (
        "too_many_files",
        "had more files open at once than one program is allowed",
        "Close what you open: `with open(…) as file:` does it by itself.",
    ),
    "BlockingIOError: [Errno 11]": ("too_many_processes", *LIMITS[Ended.TOO_MANY_PROCESSES]),
    "RuntimeError: can't start new thread": ("too_many_processes", *LIMITS[Ended.TOO_MANY_PROCESSES]),
    "MemoryError": ("out_of_memory", *LIMITS[Ended.OUT_OF_MEMORY]),
}
"""Limits that raise an error in the program. Maps the beginning of the error's text to the key of the diagnosis, the
message for the student, and the advice.
"""


_LOOP = "Look for a call that waits without a limit or a loop that never ends."
_CAUSES = {
    "hung before": (
        "cell_timed_out",
        "`{name}` did not end in the cell that begins with “{title}”. This check waited {limit:g} s for it, and it did "
        "not end here, either.",
        _LOOP,
    ),
    "check too slow": (
        "cell_timed_out",
        "The check cell was stopped after {limit:g} s, before the judge had seen enough.",
        _LOOP,
    ),
    "cell too slow": (
        "cell_timed_out",
        "The cell that begins with “{title}” was stopped at its time limit, so no check could begin.",
        "Look for a loop that never ends. To keep a node running, spin it in the background.",
    ),
    "cell endless": (
        "cell_timed_out",
        "The cell that begins with “{title}” never ended and was stopped at its time limit. The judge saw only what "
        "that cell had defined by then.",
        "Look for a loop that never ends. To keep a node running, spin it in the background.",
    ),
    "cell never ended": (
        "notebook_timed_out",
        "The cell that begins with “{title}” did not end within its time limit, nor after an interrupt.",
        "Look for a loop that never ends. Restart the kernel and run all cells: each must end.",
    ),
    "notebook too slow": (
        "notebook_timed_out",
        "The notebook's time was over before this check cell could run.",
        "Look for a loop that never ends. Restart the kernel and run all cells: each must end.",
    ),
    "kernel ended": (
        "kernel_died",
        "The notebook's kernel ended {place}.",
        "Look for `exit()`, `quit()` or `os._exit()`, or for something that makes Python crash. Restart the kernel and "
        "run all cells: that is what the grader does.",
    ),
    "not requested": (
        "not_asked",
        "The check cell ran, but it never requested its check.",
        "Make sure that no cell of yours redefines `check`.",
    ),
}
"""For each cause that keeps a judge from its verdict: the key of the diagnosis, what happened, and what the student
should do now. Errors and the limits of a box have texts of their own.
"""


def zero_points(check: CellCheck, key: str, reason: str, next_step: str, detail: str = "") -> Verdict:
    """Return the verdict of a failed check without criteria.

    Args:
        check: The check that should have been made.
        reason: What happened, in words for the student.
        next_step: What the student should do now.
        detail: Further text, such as the end of a traceback.
    """
    return failed(check.exercise, check.title, check.points, Diagnosis(key, reason, next_step), detail)


def grader_trouble(check: CellCheck, reason: str) -> Verdict:
    """Return the verdict after a failure of the grader itself. It says that the student is not to blame."""
    return not_checked(
        check.exercise,
        check.title,
        check.points,
        f"This could not be checked: {reason}",
        "This is the grader's trouble, not yours. The next grading run tries again.",
    )


def without_verdict(
    check: CellCheck,
    run: CellRun,
    before: list[tuple[str, CellRun]],
    limit: float,
    hung: tuple[str, str] | None = None,
) -> Verdict:
    """Return a verdict that says why the judge gave none for a check cell.

    Args:
        check: The check that should have been made.
        run: The result of executing the check cell.
        before: The cells since the last check, in order, each with its title.
        limit: The time limit of the check cell in seconds of wall time.
        hung: The name of a function or class in the cell that hung before, and the title of the cell in which it hung;
            None if none hung.
    """
    # Each case names the most probable cause, since no judge saw the subject.
    match run.ended:
        case Ended.NOT_RUN | Ended.KERNEL_DIED:
            return _kernel_gone(check, run, before)
        case Ended.TIMED_OUT if hung is not None:
            return _because(check, "hung before", name=hung[0], title=hung[1], limit=limit)
        case Ended.TIMED_OUT:
            return _because(check, "check too slow", limit=limit)
        case Ended.RAISED:
            return _stopped_by_error(check, run, before)
        case Ended.DONE:
            return _because(check, "not requested")
        case limit_exceeded:
            return _limit_exceeded(check, limit_exceeded, None)


def with_endless_cell(verdict: Verdict, title: str) -> Verdict:
    """Return the judge's verdict; if it failed after an endless cell of the student's, with a diagnosis of that cell.

    Args:
        verdict: The judge's verdict, whose points and criteria stay.
        title: The title of the cell that was stopped at its time limit; empty if none was.
    """
    if not title or verdict.state is not State.FAILED:
        return verdict
    return replace(verdict, diagnosis=_diagnosis("cell endless", title=title))


def _diagnosis(cause: str, **words: Any) -> Diagnosis:
    """Return the diagnosis for one of ``_CAUSES``. The words, such as a cell's title, are put into its text."""
    key, reason, next_step = _CAUSES[cause]
    return Diagnosis(key, reason.format(**words), next_step)


def _because(check: CellCheck, cause: str, **words: Any) -> Verdict:
    return failed(check.exercise, check.title, check.points, _diagnosis(cause, **words), "")


def _place(title: str | None) -> str:
    """Return the words for the cell with this title; for the check cell itself if the title is None."""
    return "this check cell" if title is None else f"the cell that begins with “{title}”"


def _limit_exceeded(check: CellCheck, ended: Ended, title: str | None) -> Verdict:
    what, next_step = LIMITS[ended]
    reason = f"In {_place(title)}, the notebook {what}. It was stopped there."
    return zero_points(check, str(ended), reason, next_step)


def _kernel_gone(check: CellCheck, run: CellRun, before: list[tuple[str, CellRun]]) -> Verdict:
    if run.ended is Ended.KERNEL_DIED:
        return _because(check, "kernel ended", place="while this check cell was running")
    for title, cell in before:
        if cell.ended in LIMITS:
            return _limit_exceeded(check, cell.ended, title)
    for title, cell in before:
        if cell.ended is Ended.KERNEL_DIED:
            place = f"in {_place(title)}, before this check cell had its turn"
            return _because(check, "kernel ended", place=place)
    slow = [title for title, cell in before if cell.ended is Ended.TIMED_OUT]
    return _because(check, "cell never ended" if slow else "notebook too slow", title="".join(slow[-1:]))


def _stopped_by_error(check: CellCheck, run: CellRun, before: list[tuple[str, CellRun]]) -> Verdict:
    """Return a verdict that names the error that stopped the cell. The cause is often an earlier cell."""
    # Of two errors, the first one has to be corrected first: the other may go with it.
    stopped = (Ended.RAISED, Ended.TIMED_OUT, *LIMITS)
    title, first = next((one for one in before if one[1].ended in stopped), (None, run))
    # An earlier cell that was stopped explains the error here better than the error itself, such as a NameError.
    if first.ended in LIMITS:
        return _limit_exceeded(check, first.ended, title)
    if first.ended is Ended.TIMED_OUT:
        return _because(check, "cell too slow", title=title)
    place = _place(title)
    for begins, (key, what, next_step) in _SHORTAGES.items():
        if first.error.startswith(begins):
            reason = f"In {place}, the notebook {what}."
            return zero_points(check, key, reason, next_step, _end_of_traceback(first))
    if first.error.startswith(_NO_INPUT):
        reason = f"{place[0].upper()}{place[1:]} stopped, so the check could not begin. {ASKS_FOR_INPUT.text}"
        return zero_points(check, ASKS_FOR_INPUT.key, reason, ASKS_FOR_INPUT.next_step)
    return zero_points(
        check,
        "syntax_error" if first.error.startswith(_SYNTAX_ERRORS) else "crashed",
        f"The check could not begin: {_told(run.error)}."
        if title is None
        else f"The cell that begins with “{title}” ended with {_told(first.error)}, so the check could not begin.",
        "Correct the first cell that shows an error, then restart the kernel and run all cells.",
        _end_of_traceback(first),
    )


def _told(error: str) -> str:
    """Return an error's text without the name that IPython gives to the file of a cell."""
    return re2.sub(r"\(\d+\.py, line (\d+)\)", r"(line \1)", error).strip().rstrip(":.")


def _end_of_traceback(run: CellRun) -> str:
    for output in run.outputs:
        if output["output_type"] == "error":
            return "\n".join(output["traceback"])[-2000:]
    return ""


def verdict_by_tests(check: CellCheck, run: CellRun) -> Verdict | None:
    """Return the verdict on a cell of plain tests.

    Args:
        check: The check of the cell. Its points are those of the gradebook.
        run: The result of executing the cell.

    Returns:
        The verdict; None if the cell was stopped by something other than a failing test.
    """
    # A failing `assert` decides for all points, as in nbgrader; only other results may give a part of them.
    if run.ended is Ended.RAISED and run.error.startswith(_ASSERTION):
        said = run.error.removeprefix(_ASSERTION).lstrip(": ").strip()
        text = f"A test in this cell failed: {said}" if said else "A test in this cell failed."
        step = "Read the line with the arrow in the output: it says which test it was."
        return _tested(check, 0.0, Diagnosis("assertion_failed", text, step))
    if run.ended is Ended.RAISED and run.error.startswith(_STUB):
        text = "The task that this cell tests is not solved yet."
        step = "Write your answer instead of the line `raise NotImplementedError()`."
        return _tested(check, 0.0, Diagnosis("not_written", text, step))
    if run.ended is not Ended.DONE:
        return None
    score = min(check.points, _partial_credit(run.outputs, check.points))
    if score < check.points:
        text = f"The tests of this cell give {score:g} of {check.points:g} points."
        return _tested(check, score, Diagnosis("partial_credit", text))
    return _tested(check, score, None)


def _partial_credit(outputs: Iterable[Mapping[str, Any]], most: float) -> float:
    """Return the value of the cell as points if it is a number; otherwise all points."""
    values = [one["data"].get("text/plain", "") for one in outputs if one["output_type"] == "execute_result"]
    try:
        score = float(values[0]) if values else most
    except ValueError:
        return most
    return score if score >= 0 else most


def _tested(check: CellCheck, score: float, diagnosis: Diagnosis | None) -> Verdict:
    state = State.FAILED if diagnosis else State.PASSED
    return Verdict(check.exercise, check.title, state, score, check.points, diagnosis=diagnosis)
