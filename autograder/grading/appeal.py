"""Writes an appeal file from a class: what the student handed in, what the judge saw, and what it decided."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from autograder import exercises
from autograder.appeals.appeal_file import Appeal, AppealedCell, dump
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.errors import GradingError, clear_disk_errors, clear_place_errors, course_command
from autograder.judge.verdicts import reference
from autograder.judge.verdicts.keeping import NoEvidence, unpack
from autograder.regular_files import write_whole
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from autograder.grading.class_records import Entered, RunCell

FOLDER = "appeals"
"""The name of the folder, in a class, for appeal files."""


def write_appeal(path: Path, student: str, exercise_id: str, to: Path | None = None) -> Path:
    """Write the appeal file of one check, and return its path.

    Args:
        path: The class directory.
        student: The student's id.
        exercise_id: The exercise's id, such as ``"lab_1_2.talker"``.
        to: The file to write; by default a file in the class.

    Raises:
        GradingError: The check does not exist, or its evidence was not kept. The message says what to do.
    """
    directory = ClassDirectory(path)
    try:
        task = exercises.get(exercise_id).task
    except (exercises.UnknownExercise, exercises.BrokenExercise) as error:
        raise GradingError(f"{error} `{COMMAND} check` lists the exercises.") from error
    with clear_disk_errors(directory.path), ClassStore(directory) as store:
        content = dump(_appeal(directory, store, student, exercise_id, task))
        to = (to or directory.path / FOLDER / f"{student}-{exercise_id}.json").absolute()
        with clear_place_errors(to, "-o"):
            write_whole(to, content)
    return to


def _appeal(
    directory: ClassDirectory, store: ClassStore, student: str, exercise_id: str, task: str
) -> Appeal:
    again = course_command("grade", directory.path, "--student", student)
    kept, entered = store.evidence(student, exercise_id), store.entered()
    if kept is None:
        raise GradingError(_why_nothing(directory, entered, student, exercise_id, again))
    known = entered.get((student, kept.assignment))
    if known is None or known.tasks.get(kept.notebook) != kept.task:
        raise GradingError(
            f"The gradebook does not have the points that the judge gave {student} in {kept.notebook} when it saw "
            f"this, as after `--dry-run` or after a run that could not check it. Enter them first: {again}"
        )
    try:
        seen, cells = unpack(kept.checks[exercise_id]), kept.run_cells()
    except (NoEvidence, ValueError) as error:
        raise GradingError(
            f"What is kept of {exercise_id} by {student} is damaged ({error}). Judge it again: {again} --again"
        ) from error
    return Appeal(
        student=student,
        assignment=kept.assignment,
        notebook=kept.notebook,
        task=task,
        course=kept.course,
        solution=list(_before(cells, exercise_id)),
        expected=_expected(exercise_id, seen.reference),
        seen=seen,
    )


def _before(cells: list[RunCell], exercise_id: str) -> Iterator[AppealedCell]:
    """Yield the student's cells above the check, which all ran in the same kernel before the check."""
    for cell in cells:
        if cell.checks == exercise_id:
            return
        if not cell.checks:
            yield AppealedCell(cell.name, cell.text.splitlines())


def _expected(exercise_id: str, digest: str) -> Any:
    if reference.digest(exercise_id) != digest:
        return None
    return json.loads(exercises.reference_path(exercise_id).read_text(encoding="utf-8"))


def _why_nothing(
    directory: ClassDirectory,
    entered: Mapping[tuple[str, str], Entered],
    student: str,
    exercise_id: str,
    again: str,
) -> str:
    for assignment in directory.assignments():
        known = entered.get((student, assignment))
        for row in known.rows if known else ():
            if row.exercise == exercise_id:
                return (
                    f"Nothing that a judge saw of {exercise_id} by {student} is kept. The table says: {row.state}"
                    f"{f', {row.diagnosis}' if row.diagnosis else ''}. {row.reason}".rstrip()
                    + " If a check never began, as after a cell that raised an error, there is nothing to keep. "
                    f"If it was graded before evidence was kept, type: {again} --again"
                )
    return (
        f"No check of {exercise_id} by {student!r} was graded here: the class has the assignments "
        f"{', '.join(directory.assignments()) or 'none'}. `{course_command('attempts', directory.path, 'STUDENT')}` "
        "lists what was graded."
    )
