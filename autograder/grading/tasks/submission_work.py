"""Defines what the steps of a run hand on about a submission. Each step makes a new record; none is changed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import Submission

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nbformat import NotebookNode

    from autograder.execution.executed_cells import Execution
    from autograder.grading.class_records import ResultKey
    from autograder.grading.classes.gradebook_reading import SubmissionEntry
    from autograder.grading.grading_task import Task
    from autograder.grading.table.rows import Row


@dataclass(frozen=True)
class Work(Submission):
    """A submission, as it was found at the beginning of a run.

    Attributes:
        made_from: The key that its result has if it is made from the files at the beginning of the run.
        notebooks: The names of the assignment's notebooks.
    """

    made_from: ResultKey
    notebooks: Sequence[str]


@dataclass(frozen=True)
class MadeTask:
    """A notebook of a submission as a task, with the rebuilt notebook from which the task was made."""

    work: Work
    task: Task
    rebuilt: NotebookNode


@dataclass(frozen=True)
class Result(MadeTask):
    """A task with its result.

    Attributes:
        is_new: True if the notebook was executed in this run.
    """

    execution: Execution
    is_new: bool = False


@dataclass(frozen=True)
class Entered:
    """A submission, after its results were entered into the gradebook.

    Attributes:
        rows: The results as rows of the report.
        entry: The submission's entry in the gradebook; None if the results are not in the gradebook: in a dry run, or
            if they could not be entered.
        shown: The hash of the gradebook's entry from which the feedback pages were made; empty without pages.
    """

    work: Work
    rows: tuple[Row, ...]
    entry: SubmissionEntry | None
    shown: str = ""
