"""Writes the appeal file of one check: the student's cells and page, the judge's evidence, and the verdict."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.appeals.appeal_file import AppealedCell, AppealedCheck, dump
from autograder.command_name import COMMAND
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import GradingError, clear_disk_errors, course_command, write_output
from autograder.judge import evidence_files
from autograder.judge.evidence_files import NoEvidence, unpack

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from autograder.grading.class_records import Attempt, RunCell


FOLDER = "appeals"
"""The name of a class's folder for appeal files."""
_MAX_PAGE = 8_000_000
"""The maximum size in bytes of a feedback page in an appeal file. A larger one is only in the class."""


def write_appeal(path: Path, student: str, exercise_id: str, to: Path | None = None) -> Path:
    """Write the appeal file of one check, and return its path.

    Args:
        path: The class directory.
        exercise_id: The exercise's id, such as ``"lab_1_2.talker"``.
        to: The path of the appeal file; by default in the class's folder ``appeals``.

    Raises:
        GradingError: The check does not exist, or its evidence is not stored. The message says what to do.
    """
    directory = ClassDirectory(path)
    try:
        task = exercises.get(exercise_id).task
    except (exercises.UnknownExercise, exercises.BrokenExercise) as error:
        raise GradingError(f"{error} `{COMMAND} check` lists the exercises.") from error
    with clear_disk_errors(directory.path), ClassStore(directory) as store:
        content = _content(directory, store, student, exercise_id, task)
        to = (to or directory.path / FOLDER / f"{student}-{exercise_id}.zip").absolute()
        write_output(to, content, "-o")
    return to


def _content(
    directory: ClassDirectory, store: ClassStore, student: str, exercise_id: str, task: str
) -> bytes:
    again = course_command("grade", directory.path, "--student", student)
    stored, entered = store.evidence(student, exercise_id), store.entered()
    if stored is None:
        raise GradingError(_why_nothing(directory, store.attempts(student), student, exercise_id, again))
    record = entered.get((student, stored.assignment))
    # An appeal is about the grade that the student sees, so the evidence must come from the run that gave this grade.
    if record is None or record.tasks.get(stored.notebook) != stored.task:
        raise GradingError(
            f"The points of {student} for this check of {stored.notebook} are not in the gradebook, for example "
            f"because the last run was a `--dry-run`. Enter the points first: {again}"
        )
    try:
        evidence, cells = unpack(stored.checks[exercise_id]), stored.run_cells()
    except (NoEvidence, ValueError) as error:
        raise GradingError(
            f"The evidence of {exercise_id} by {student} is damaged ({error}). Judge the check again: {again} --again"
        ) from error
    solution = list(_before(cells, exercise_id))
    check = AppealedCheck(student, stored.assignment, stored.notebook, task, stored.course, solution)
    page = directory.path / "feedback" / student / stored.assignment / f"{stored.notebook}.html"
    others = {}
    if page.is_file() and page.stat().st_size < _MAX_PAGE:
        others["page.html"] = page.read_bytes()
    if evidence_files.reference_digest(exercise_id) == evidence.reference:
        expected = exercises.reference_path(exercise_id).read_bytes()
        if evidence.expected:  # the student was given a drawing of the class, not one of this file
            stored_reference = evidence_files.load_reference(exercise_id)
            drawn = replace(stored_reference, parts=evidence.expected, variants=())
            expected = evidence_files.dump_reference(drawn).encode()
        others["expected.json"] = expected
    return dump(check, stored.checks[exercise_id], others)


def _before(cells: list[RunCell], exercise_id: str) -> Iterator[AppealedCell]:
    """Yield the cells that the student wrote and that ran before the check."""
    for cell in cells:
        if cell.checks == exercise_id:
            return
        if not cell.checks:
            yield AppealedCell(cell.name, cell.text.splitlines())


def _why_nothing(
    directory: ClassDirectory, attempts: Sequence[Attempt], student: str, exercise_id: str, again: str
) -> str:
    for attempt in reversed(attempts):
        for row in attempt.rows:
            if row.exercise == exercise_id:
                return (
                    f"No evidence of {exercise_id} by {student} is stored. The state in the table is: {row.state}"
                    f"{f', {row.diagnosis}' if row.diagnosis else ''}. {row.reason}".rstrip()
                    + " If the check never began, for example after a cell that raised an error, no evidence exists. "
                    f"If an older version of the course graded the check, type: {again} --again"
                )
    return (
        f"No check of {exercise_id} by {student!r} was graded in this class. The class's assignments are: "
        f"{', '.join(directory.assignments()) or 'none'}. To list a student's graded checks: "
        f"{course_command('attempts', directory.path, 'STUDENT')}"
    )
