"""The one conversion: a graded submission as it is in ``autograded/``, and what the gradebook has to hold of it.

It leaves behind what nbgrader's own conversion would, in a twentieth of the time: that one reads, validates and writes
every notebook twice and opens the gradebook a dozen times.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec
from nbformat.v4 import rwbase
from nbgrader.preprocessors import LimitOutput
from nbgrader.utils import compute_checksum, determine_grade, is_grade, is_solution, is_task

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.classes.timestamps import companions
from autograder.grading.entering.gradebook import NotebookEntry
from autograder.grading.entering.results import with_results
from autograder.grading.rebuilding.task_making import rebuilt_notebook, task_of
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from nbformat import NotebookNode

    from autograder.boxes.execution import Execution
    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.task import Task

_READ_ONLY = 0o444


class ChangedMeanwhile(RuntimeError):
    """The submission is not any more what was executed; the message says what to do."""


def convert(
    directory: ClassDirectory,
    submission: Submission,
    results: Sequence[tuple[Task, Execution]],
    folder: Path,
) -> dict[str, NotebookEntry]:
    """Write the notebooks of a submission with their results, and say what the gradebook has to hold.

    Args:
        directory: The class.
        submission: What was executed.
        results: A pair for each notebook of the assignment.
        folder: Where the notebooks go; made here, and not there before.

    Returns:
        By notebook.

    Raises:
        ChangedMeanwhile: A notebook was replaced while it was executed.
        OSError: Something could not be written.
    """
    folder.mkdir(parents=True)
    for name, data in directory.files(submission.assignment).items():
        _write(folder / name, data)
    write_companions(submission, folder)
    entries = {}
    for task, execution in results:
        notebook = _graded(directory, submission, task, execution)
        LimitOutput(config=directory.config).preprocess(notebook, {})
        entries[task.notebook] = _entry(notebook)
        _write(folder / f"{task.notebook}{SUFFIX}", _text(notebook))
    return entries


def write_companions(submission: Submission, folder: Path) -> None:
    """Have nbgrader's files of when a submission came, and by which secret, follow it to a folder.

    Raises:
        OSError: They could not be written.
    """
    for name, data in companions(submission.folder).items():
        _write(folder / name, data)


def _graded(
    directory: ClassDirectory, submission: Submission, task: Task, execution: Execution
) -> NotebookNode:
    master = directory.master(submission.assignment, task.notebook)
    rebuilt, problem = rebuilt_notebook(submission.folder / f"{task.notebook}{SUFFIX}", master)
    now = task_of(directory, task.student, task.assignment, task.notebook, rebuilt.notebook, problem)
    if now.key() != task.key():
        raise ChangedMeanwhile(
            f"{task.label} was changed while it was graded: grade it again to take the new one"
        )
    return with_results(rebuilt.notebook, task, execution)


def _text(notebook: NotebookNode) -> bytes:
    """The notebook as nbformat writes it, which takes pure Python to indent; ``notebook`` is changed."""
    split: Any = rwbase.split_lines
    strip: Any = rwbase.strip_transient
    encoded = msgspec.json.encode(strip(split(notebook)), order="sorted")
    return msgspec.json.format(encoded, indent=1) + b"\n"


def _entry(notebook: NotebookNode) -> NotebookEntry:
    """The entry that nbgrader's SaveAutoGrades would make."""
    scores: dict[str, float | None] = {}
    comments: dict[str, str | None] = {}
    for cell in notebook.cells:
        if is_grade(cell):
            scores[cell.metadata.nbgrader.grade_id] = determine_grade(cell)[0]
        if is_solution(cell) or is_task(cell):
            comments[cell.metadata.nbgrader.grade_id] = _comment(cell)
    return NotebookEntry(scores, comments)


def _comment(cell: Any) -> str | None:
    untouched = cell.metadata.nbgrader.get("checksum") == compute_checksum(cell)
    return "No response." if untouched and not is_task(cell) else None


def _write(path: Path, data: bytes) -> None:
    write_whole(path, data)
    path.chmod(_READ_ONLY)
