"""Holds the state of a submission during a run: its tasks, until their results are in the gradebook."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nbformat import NotebookNode

    from autograder.execution.executed_cells import Execution
    from autograder.grading.class_records import ResultKey
    from autograder.grading.classes.class_directory import Submission
    from autograder.grading.grading_task import Task
    from autograder.grading.table.rows import Row


@dataclass
class Work:
    """The state of a submission during a run.

    Attributes:
        made_from: The key that its result has if it is made from the files at the beginning of the run.
        notebooks: The names of the assignment's notebooks.
        results: The results by notebook, until they are entered into the gradebook.
        rebuilt: The rebuilt notebooks that are executed or have results, until the results are entered.
        rows: The results as rows of the report; None if the submission has not been graded yet.
        written: True if the gradebook contains these results.
        shown: The hash of the gradebook's entry from which the feedback pages were made; empty without pages.
    """

    submission: Submission
    made_from: ResultKey
    notebooks: Sequence[str]
    results: dict[str, tuple[Task, Execution]] = field(default_factory=dict)
    rebuilt: dict[str, NotebookNode] = field(default_factory=dict)
    rows: tuple[Row, ...] | None = None
    written: bool = False
    shown: str = ""

    @property
    def key(self) -> tuple[str, str]:
        """The student and the assignment, which together identify the submission in the gradebook."""
        return self.submission.student, self.submission.assignment

    @property
    def complete(self) -> bool:
        """True if each notebook of the submission has a result."""
        return len(self.results) == len(self.notebooks)

    @property
    def pairs(self) -> list[tuple[Task, Execution]]:
        """The tasks with their results, in the order of the notebooks."""
        return [self.results[notebook] for notebook in self.notebooks]
