"""Records reference outputs: a judge watches the solution in each master, as it watches a student's answer.

The grader expects of students what the recorded solution did. After a change of a solution, record it again.
"""

from __future__ import annotations

import json
import os
import secrets
import subprocess
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import msgspec

from autograder import course, exercises
from autograder.authoring import answer_bank
from autograder.judge import evidence_files
from autograder.judge.check_process import Child
from autograder.judge.controlled_judge import JudgeDied, JudgeProcess
from autograder.judge.recording_differences import differences
from autograder.kit.evidence import Variant
from autograder.masters.master_files import MasterError
from autograder.masters.reference_solutions import ReferenceSolution, reference_source
from autograder.messages.judge_messages import SOCKET_VARIABLE, Report
from autograder.safe_files import HeldFolder
from course_runtime.python_child import installed_program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from autograder.kit.evidence import Reference
    from autograder.kit.model import Exercise
    from autograder.verdict import Verdict


_RUN_LIMIT = 600.0
"""Time limit in seconds for running one reference solution, which may build a workspace twice."""


class CannotRecord(RuntimeError):
    """A reference solution could not be run, or does not meet the criteria of its exercise."""


_DIFFERENCES = 12
"""Differences of a recording that are printed at most: a changed step moves all that comes after it."""


def record(wanted: Iterable[Exercise], *, only_check: bool, tell: Callable[[str], object]) -> list[str]:
    """Record reference outputs and store them.

    Args:
        wanted: The exercises.
        only_check: True to compare with the stored reference outputs, and to store nothing.
        tell: Called with one line for each exercise.

    Returns:
        The ids of the exercises whose new reference output differs from the stored one, or has no stored one.

    Raises:
        CannotRecord: A solution could not be recorded. The reference outputs recorded before it are stored.
    """
    changed = []
    for exercise in wanted:
        text = recording(exercise)
        file = exercises.reference_path(exercise.id)
        different = [] if not file.exists() else _different(file, text, exercise.tolerance)
        if file.exists() and not different:
            tell(f"{exercise.id}: unchanged")
            continue
        changed.append(exercise.id)
        if not only_check:
            file.write_text(text, encoding="utf-8")
        what = "differs from" if only_check else "recorded in"
        tell("\n  ".join([f"{exercise.id}: {what} {file.relative_to(course.root())}", *different]))
    return changed


def _different(file: Path, text: str, tolerance: float) -> list[str]:
    """Return in words how a new recording differs from the stored one."""
    try:
        stored = _parsed(file.read_text(encoding="utf-8"))
    except (ValueError, KeyError, TypeError) as error:
        return [f"the stored file is not a recording ({error})"]
    said = list(differences(stored, _parsed(text), tolerance))
    more = len(said) - _DIFFERENCES
    return said[:_DIFFERENCES] + [f"and {more} more differences"] * (more > 0)


def _parsed(text: str) -> Reference:
    return evidence_files.parse_reference(json.loads(text))


def recording(exercise: Exercise) -> str:
    """Record the reference output of an exercise, and return it as text.

    Raises:
        CannotRecord: No master has the exercise, or the solution does not meet the criteria of the exercise.
    """
    report, output = judged(exercise.id, program(exercise.id), record=True)
    if report.reference is None or report.verdict is None:
        raise CannotRecord(
            f"{exercise.id}: {report.trouble or 'the solution never called check'}\n{output}".strip()
        )
    if not report.verdict.passed:
        interface = json.loads(report.reference)["interface"]
        missing = " and no ".join(role for role in exercise.roles if role not in interface)
        has_none = f" The solution has no {missing}, which this recipe judges." * bool(missing)
        failed = (criterion for criterion in report.verdict.criteria if not criterion.passed)
        missed = "".join(f"\n  {c.title}: expected {c.expected}; seen {c.seen}" for c in failed)
        raise CannotRecord(
            f"{exercise.id}: the solution in {course.LAB} does not meet the criteria of its exercise.{has_none}{missed}"
        )
    return _with_variants(report.reference, exercise)


def _with_variants(text: str, exercise: Exercise) -> str:
    """Return a recording with the records of the wrong answers that have a card's text in their table."""
    reference = _parsed(text)
    variants = []
    for answer in answer_bank.answers([exercise.id]):
        if answer.advice:
            child = Child(partial(_variant, answer, reference), _RUN_LIMIT).result()
            report = (
                msgspec.json.decode(child.data, type=Report) if child.data else Report(trouble=child.trouble)
            )
            if report.reference is None:
                raise CannotRecord(f"{answer.name}: {report.trouble}")
            card, next_step = answer.advice
            variants.append(Variant(answer.diagnoses[0], card, next_step, _parsed(report.reference).parts))
    with_variants = replace(reference, variants=variants)
    return evidence_files.dump_reference(with_variants, exercise.recorded) if variants else text


def _variant(answer: answer_bank.Answer, reference: Reference) -> bytes:
    return msgspec.json.encode(answer.recorded(reference))


def unsolved(exercise: Exercise) -> Verdict | None:
    """Return the verdict on the notebook as students get it; None if the notebook ends before its check.

    Raises:
        CannotRecord: No master checks the exercise, or its master cannot be used.
    """
    report, _ = judged(exercise.id, program(exercise.id, solved=False))
    return report.verdict


def judged(exercise_id: str, text: str, *, record: bool = False) -> tuple[Report, str]:
    """Run a program next to a judge. Return the judge's report, and what the program printed.

    Raises:
        CannotRecord: The judge died, or the program did not end.
    """
    with HeldFolder("autograder-record-") as folder:
        file = folder.path / "reference_solution.py"
        file.write_text(text, encoding="utf-8")
        try:
            with JudgeProcess(folder.path / "judge", seed=secrets.token_hex(8)) as judge:
                judge.open(exercise_id, record=record)
                output = _run(file, judge.socket_path)
                return judge.close(), output
        except JudgeDied as error:
            raise CannotRecord(f"{exercise_id}: {error}") from error
        except subprocess.TimeoutExpired as error:
            raise CannotRecord(f"{exercise_id}: the notebook did not end within {_RUN_LIMIT:g} s") from error


def program(exercise_id: str, *, solved: bool = True) -> str:
    """Return a notebook's code up to and including the check of an exercise, as one program.

    Raises:
        CannotRecord: No master checks the exercise, or its master cannot be used.
    """
    solution = reference_solution(exercise_id, solved=solved)
    return f"{solution.source}\n\n{solution.check_cell(exercise_id)}"


def reference_solution(exercise_id: str, *, solved: bool = True) -> ReferenceSolution:
    """Return everything that a notebook defines before the check of an exercise; for the errors see :func:`program`."""
    master = exercises.path(exercise_id).with_name(course.LAB)
    if not master.is_file() or exercise_id not in master.read_text(encoding="utf-8"):
        raise CannotRecord(f"{master} does not check {exercise_id}")
    try:
        return reference_source(master, exercise_id, solved=solved)
    except MasterError as error:
        raise CannotRecord(str(error)) from error


def _run(file: Path, socket: Path) -> str:
    """Run the program. Return its output for an error message."""
    done = subprocess.run(
        [str(installed_program("python3")), str(file)],
        # A solution that consists of files writes these files into the current folder.
        cwd=file.parent,
        env=os.environ | {SOCKET_VARIABLE: str(socket)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=_RUN_LIMIT,
        check=False,
    )
    return done.stdout[-4000:]
