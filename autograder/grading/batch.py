"""Grading a class: rebuild, execute in parallel, write one after the other.

The order makes it fail closed. What is not known to be right in the gradebook is taken back first; then each
result goes into the journal and from there, by one writer, into the gradebook. A run that is killed has left
zeros and results, never a wrong grade, and the next run goes on from there.
"""

from __future__ import annotations

import contextlib
import os
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from autograder.grading import engine, gradebook
from autograder.grading.class_directory import ClassDirectory, Refused, Submission
from autograder.grading.errors import ClassIncomplete, GradingError, clear_disk_errors, is_disk_full
from autograder.grading.journal import Journal
from autograder.grading.preparing import tasks_of
from autograder.grading.progress import BatchProgress
from autograder.grading.rebuild import grade_id, is_check
from autograder.grading.report import NOT_GRADED, NOT_SUBMITTED, GradeReport, Row, rows_of, write_csv
from autograder.grading.worker import JUDGE
from autograder.grading.writer import NotWritten, Writer

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.boxes.execution import Execution
    from autograder.grading.task import Task


@dataclass
class _Work:
    """A submission on its way through the batch."""

    submission: Submission
    tasks: list[Task]
    results: dict[str, Execution] = field(default_factory=dict)
    """By notebook."""
    written: bool = False
    """Whether the gradebook holds exactly these results."""

    @property
    def complete(self) -> bool:
        return len(self.results) == len(self.tasks)

    @property
    def pairs(self) -> list[tuple[Task, Execution]]:
        return [(task, self.results[task.notebook]) for task in self.tasks]


def grade(
    path: Path,
    *,
    assignments: Sequence[str] = (),
    students: Sequence[str] = (),
    jobs: int | None = None,
    again: bool = False,
    feedback: bool = True,
    console: Console | None = None,
    judge: str = JUDGE,
) -> GradeReport:
    """Grade what was submitted in a class.

    Args:
        path: The class directory.
        assignments: Only these; all by default.
        students: Only these; all by default.
        jobs: Notebooks executed at once; as many as there are processors by default.
        again: Execute everything anew, also what is unchanged.
        feedback: Make the pages that go back to the students.
        console: Where progress is shown; standard error by default.
        judge: What makes a judge, as ``module:class``.

    Returns:
        The report. Submissions that could not be graded are in it, with zero points and the reason.

    Raises:
        GradingError: The class cannot be graded: it is none, it is busy, the disk is full.
    """
    began = time.monotonic()
    directory = ClassDirectory(Path(path))
    console = console or Console(stderr=True)
    from autograder.grading import sandboxing

    sandboxing.require(directory)
    with directory.lock(), clear_disk_errors(directory.path):
        _check_release(directory)
        batch = _Batch(directory, console, jobs or os.cpu_count() or 1, judge)
        batch.collect(assignments, students)
        batch.plan(again)
        batch.run()
        if feedback:
            batch.feedback()
        return batch.report(time.monotonic() - began)


class _Batch:
    def __init__(self, directory: ClassDirectory, console: Console, workers: int, judge: str) -> None:
        self._directory = directory
        self._console = console
        self._workers = workers
        self._judge = judge
        self._journal = Journal(directory.state / "journal")
        self._writer = Writer(directory)
        self._works: list[_Work] = []
        self._others: list[_Work] = []
        self._refused: list[Refused] = []
        self._problems: list[str] = []
        self._executed = 0
        self._reused = 0
        self._written = 0

    def collect(self, assignments: Sequence[str], students: Sequence[str]) -> None:
        """Find the submissions and rebuild their notebooks."""
        found, refused = self._directory.submissions()
        _check_known(assignments, self._directory.assignments(), "assignment")
        _check_known(students, sorted({submission.student for submission in found}), "student")
        self._refused = refused
        for submission in found:
            work = _Work(submission, tasks_of(self._directory, submission))
            chosen = not assignments or submission.assignment in assignments
            chosen = chosen and (not students or submission.student in students)
            (self._works if chosen else self._others).append(work)

    def plan(self, again: bool) -> None:
        """Settle what is known already, and take back the grades of all the rest."""
        works = [*self._works, *self._others]
        in_gradebook = {
            assignment: gradebook.scores(self._directory.gradebook_url, assignment)
            for assignment in {work.submission.assignment for work in works}
        }
        for work in self._works:
            for task in work.tasks:
                if again:
                    self._journal.forget(task)
        for work in works:
            for task in work.tasks:
                known = task.without_execution() if task.problem else self._journal.get(task)
                if known is not None:
                    work.results[task.notebook] = known
            scores = in_gradebook[work.submission.assignment].get(work.submission.student, {})
            work.written = work.complete and self._writer.is_written(work.submission, work.tasks, scores)
        for work in self._others:
            if not work.written:
                work.results.clear()  # known perhaps, but not what the gradebook says
        self._reused = sum(
            not task.problem for w in self._works for task in w.tasks if task.notebook in w.results
        )
        self._writer.take_back([work.submission for work in self._works if not work.written])

    def run(self) -> None:
        """Execute what must be, and write each submission as soon as it is complete."""
        owners = {
            id(task): work for work in self._works for task in work.tasks if task.notebook not in work.results
        }
        tasks = [task for work in self._works for task in work.tasks if id(task) in owners]
        for work in self._works:
            if work.complete and not work.written:
                self._write(work)
        if not tasks:
            return
        with BatchProgress(self._console, len(tasks)) as progress:
            results = engine.execute_all(
                tasks,
                self._directory.scratch() / "batch",
                self._workers,
                on_start=lambda _: progress.started(),
                judge=self._judge,
            )
            with contextlib.closing(results):
                for done in results:
                    self._executed += 1
                    self._journal.put(done.task, done.execution)
                    if done.execution.trouble:
                        self._problems.append(
                            f"{done.task.label} could not be checked: {done.execution.trouble}"
                        )
                    work = owners[id(done.task)]
                    work.results[done.task.notebook] = done.execution
                    progress.finished(done.task.label, failed=bool(done.execution.trouble))
                    if work.complete:
                        self._write(work)

    def feedback(self) -> None:
        """Make the pages of what was written now, and of what has none."""
        wanting = [
            w for w in self._works if w.written and not self._writer.has_feedback(w.submission, w.tasks)
        ]
        for assignment in sorted({work.submission.assignment for work in wanting}):
            works = [work for work in wanting if work.submission.assignment == assignment]
            self._writer.write_feedback(assignment, [work.submission for work in works])
            for work in works:
                if not self._writer.has_feedback(work.submission, work.tasks):
                    self._problem(
                        NotWritten(f"feedback for {work.submission.student}/{assignment} could not be made")
                    )

    def report(self, seconds: float) -> GradeReport:
        """The report on what was asked for; ``grades.csv``, written here, has the whole class."""
        rows = self._rows(self._works)
        write_csv(self._directory.path / "grades.csv", self._rows([*self._works, *self._others]))
        return GradeReport(
            path=self._directory.path,
            rows=tuple(rows),
            refused=tuple(self._refused),
            problems=tuple(self._problems),
            executed=self._executed,
            reused=self._reused,
            written=self._written,
            seconds=seconds,
        )

    def _write(self, work: _Work) -> None:
        try:
            self._writer.write(work.submission, work.pairs)
        except NotWritten as error:
            self._problem(error)
        else:
            work.written = True
            self._written += 1

    def _problem(self, error: NotWritten) -> None:
        if is_disk_full(error):
            raise error
        self._problems.append(f"{error} (see {self._directory.state / 'nbgrader.log'})")

    def _rows(self, works: Sequence[_Work]) -> list[Row]:
        found = {(work.submission.student, work.submission.assignment): work for work in works}
        students = sorted({student for student, _ in found})
        assignments = sorted({assignment for _, assignment in found})
        return [
            row
            for student in students
            for assignment in assignments
            for row in self._rows_of(student, assignment, found.get((student, assignment)))
        ]

    def _rows_of(self, student: str, assignment: str, work: _Work | None) -> list[Row]:
        if work is None or not work.complete:
            state = NOT_SUBMITTED if work is None else NOT_GRADED
            return [
                Row(student, assignment, exercise, 0.0, worth, state)
                for exercise, worth in _exercises(self._directory, assignment)
            ]
        rows = [row for task, execution in work.pairs for row in rows_of(task, execution)]
        if work.written:
            return rows
        reason = "The result could not be entered into the gradebook; it has zero points there."
        return [
            Row(
                row.student,
                row.assignment,
                row.exercise,
                0.0,
                row.max_score,
                "not_checked",
                "not_written_down",
                reason,
            )
            for row in rows
        ]


def _exercises(directory: ClassDirectory, assignment: str) -> Iterator[tuple[str, float]]:
    from autograder.grading.master import check_of

    for notebook in directory.notebooks(assignment):
        for cell in directory.master(assignment, notebook).cells:
            check = check_of(cell)
            if check is not None:
                yield check.exercise, check.worth


def _check_known(wanted: Sequence[str], known: Sequence[str], what: str) -> None:
    for name in wanted:
        if name not in known:
            raise GradingError(
                f"There is no {what} named {name} here. There is: {', '.join(known) or 'none'}."
            )


def _check_release(directory: ClassDirectory) -> None:
    """The gradebook must know the cells that the sources have, with the same points."""
    assignments = directory.assignments()
    if not assignments:
        raise ClassIncomplete(
            f"{directory.path / 'source'} holds no assignment. Put one there, or make a new class."
        )
    for assignment in assignments:
        entered = gradebook.worth(directory.gradebook_url, assignment)
        for notebook in directory.notebooks(assignment):
            cells = directory.master(assignment, notebook).cells
            wanted = {
                grade_id(cell): float(cell.metadata.nbgrader["points"]) for cell in cells if is_check(cell)
            }
            have = entered.get(notebook, {})
            if any(have.get(name) != worth for name, worth in wanted.items()):
                raise ClassIncomplete(
                    f"The gradebook does not know {notebook} as it is in "
                    f"{directory.path / 'source' / assignment}. Enter it: "
                    f"cd {directory.path} && nbgrader generate_assignment {assignment} --force"
                )
