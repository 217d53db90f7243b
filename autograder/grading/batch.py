"""Grading a class: rebuild, execute in parallel, write one after the other.

The order makes it fail closed. What is not known to be right in the gradebook is taken back first; then each
result goes into the journal and from there, by one writer, into the gradebook. A run that is killed has left
zeros and results, never a wrong grade, and the next run goes on from there.

Nothing of a submission is held longer than it takes to write it down, so that a class of any size fits.
"""

from __future__ import annotations

import contextlib
import functools
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from autograder.grading import gradebook, places
from autograder.grading.class_directory import ClassDirectory, Refused, Submission
from autograder.grading.errors import GradingError, clear_disk_errors, is_disk_full
from autograder.grading.fingerprints import Fingerprints
from autograder.grading.journal import Journal
from autograder.grading.progress import BatchProgress
from autograder.grading.records import Records
from autograder.grading.released import check_release, graded_cells
from autograder.grading.report import NOT_GRADED, NOT_SUBMITTED, GradeReport, Row, rows_of, write_csv
from autograder.grading.timings import Timings

# What only a class with something to grade needs is imported where it is used: nbgrader alone takes a second.

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.boxes.execution import Execution
    from autograder.grading.places import Execute
    from autograder.grading.released import GradedCell
    from autograder.grading.task import Task
    from autograder.grading.writer import Writer


@dataclass
class _Work:
    """A submission on its way through the batch.

    Attributes:
        submission: Where it lies.
        fingerprint: Of what it is made from, as it was at the start.
        notebooks: The names of its notebooks.
        results: What is known of the notebooks that are not written down yet, by notebook.
        rows: What the gradebook has for it, or why it has nothing; None while nothing is known.
        written: Whether the gradebook holds exactly these results.
    """

    submission: Submission
    fingerprint: str
    notebooks: Sequence[str]
    results: dict[str, tuple[Task, Execution]] = field(default_factory=dict)
    rows: tuple[Row, ...] | None = None
    written: bool = False

    @property
    def complete(self) -> bool:
        return len(self.results) == len(self.notebooks)

    @property
    def pairs(self) -> list[tuple[Task, Execution]]:
        return [self.results[notebook] for notebook in self.notebooks]


def grade(
    path: Path,
    *,
    assignments: Sequence[str] = (),
    students: Sequence[str] = (),
    jobs: int | None = None,
    again: bool = False,
    feedback: bool = True,
    console: Console | None = None,
    judge: str = "",
    scheduler: str | None = None,
) -> GradeReport:
    """Grade what was submitted in a class.

    Args:
        path: The class directory.
        assignments: Only these; all by default.
        students: Only these; all by default.
        jobs: Notebooks executed at once; as many as load and memory allow by default.
        again: Execute everything anew, also what is unchanged.
        feedback: Make the pages that go back to the students.
        console: Where progress is shown; standard error by default.
        judge: What makes a judge, as ``module:class``; the real one by default.
        scheduler: The address of a Dask scheduler whose workers execute the notebooks; this machine by default.

    Returns:
        The report. Submissions that could not be graded are in it, with zero points and the reason.

    Raises:
        GradingError: The class cannot be graded: it is none, it is busy, the disk is full, nobody can execute it.
    """
    began = time.monotonic()
    console = console or Console(stderr=True)
    directory = ClassDirectory(Path(path))
    if scheduler is None:
        from autograder.grading import sandboxing

        sandboxing.require(directory)
        place = places.here(directory, jobs, judge)
    else:
        from autograder.grading.cluster.connection import check_address, check_dask

        check_dask()
        check_address(scheduler)
        tell = functools.partial(console.print, markup=False, highlight=False, soft_wrap=True)
        place = places.on_cluster(directory, scheduler, judge, tell)
    with directory.lock(), clear_disk_errors(directory.path), contextlib.ExitStack() as stack:
        batch = _Batch(directory, console, feedback=feedback)
        batch.collect(assignments, students)
        batch.plan(again)
        # Before anything is taken back: where nobody can execute anything, all stays as it is.
        execute = stack.enter_context(place) if batch.unsettled else None
        batch.take_back()
        batch.run(execute)
        return batch.report(time.monotonic() - began)


class _Batch:
    def __init__(self, directory: ClassDirectory, console: Console, *, feedback: bool) -> None:
        self._directory = directory
        self._console = console
        self._feedback = feedback
        self._fingerprints = Fingerprints(directory)
        self._cells: dict[str, tuple[GradedCell, ...]] = graded_cells(directory, self._fingerprints)
        check_release(directory, self._cells)
        self._journal = Journal(directory.state / "journal")
        self._records = Records(directory)
        self._works: list[_Work] = []
        self._others: list[_Work] = []
        self._refused: list[Refused] = []
        self._problems: list[str] = []
        self._timings = Timings()
        self._began = time.monotonic()
        self._executed = 0
        self._reused = 0
        self._written = 0

    @functools.cached_property
    def _writer(self) -> Writer:
        from autograder.grading.writer import Writer

        return Writer(self._directory, self._records)

    def collect(self, assignments: Sequence[str], students: Sequence[str]) -> None:
        """Find the submissions."""
        found, refused = self._directory.submissions()
        _check_known(assignments, self._directory.assignments(), "assignment")
        _check_known(students, sorted({submission.student for submission in found}), "student")
        self._refused = refused
        names = {assignment: self._directory.notebooks(assignment) for assignment in self._cells}
        for submission in found:
            work = _Work(submission, self._fingerprints.of(submission), names[submission.assignment])
            chosen = not assignments or submission.assignment in assignments
            chosen = chosen and (not students or submission.student in students)
            (self._works if chosen else self._others).append(work)

    def plan(self, again: bool) -> None:
        """Settle what is known already."""
        in_gradebook = {
            assignment: gradebook.scores(self._directory.gradebook_url, assignment)
            for assignment in sorted({work.submission.assignment for work in [*self._works, *self._others]})
        }
        for work in self._others:
            self._settle(work, in_gradebook)
        for work in self._works:
            if again:
                self._journal.forget(work.submission, work.notebooks)
            else:
                self._settle(work, in_gradebook)

    @property
    def unsettled(self) -> list[Submission]:
        """The submissions of which the gradebook does not have the grades."""
        return [work.submission for work in self._works if not work.written]

    def take_back(self) -> None:
        """Take back the grades of all that is not settled."""
        if self.unsettled:
            self._writer.take_back(self.unsettled)

    def run(self, execute: Execute | None) -> None:
        """Execute what must be, and write each submission as soon as it is complete.

        Args:
            execute: Executes tasks; None where all is settled.
        """
        for work in self._works:
            if work.written:
                self._reused += len(work.notebooks)
                self._make_pages(work)
            else:
                self._take_known(work)
        waiting = [work for work in self._works if work.rows is None]
        if not waiting or execute is None:
            return
        works = {(work.submission.student, work.submission.assignment): work for work in waiting}
        missing = sum(len(work.notebooks) - len(work.results) for work in waiting)
        with BatchProgress(self._console, missing) as progress:
            self._timings.first_started = time.monotonic() - self._began
            results = execute(self._tasks(waiting), lambda _: progress.started())
            with contextlib.closing(results):
                for done in results:
                    self._timings.last_ended = time.monotonic() - self._began
                    self._take(works[done.task.student, done.task.assignment], done.task, done.execution)
                    progress.finished(done.task.label, failed=bool(done.execution.trouble))
        for work in waiting:
            if work.rows is None and work.complete:
                self._write(work)  # no notebook of it could be executed, or that was known last

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
            timings=self._timings,
        )

    def _settle(self, work: _Work, in_gradebook: dict[str, dict[str, dict[str, gradebook.Scores]]]) -> None:
        """Find out whether the gradebook has the grades of exactly this submission."""
        record = self._records.get(work.submission)
        scores = in_gradebook[work.submission.assignment].get(work.submission.student, {})
        if record is None or not self._records.holds(work.submission, record, scores):
            return
        if record.fingerprint != work.fingerprint:
            # Other bytes, but perhaps the same work: saved again, or the course was changed elsewhere.
            keys = {task.notebook: task.key() for task in self._tasks_of(work.submission)}
            if record.keys != keys:
                return
            self._records.put(work.submission, replace(record, fingerprint=work.fingerprint))
        work.rows = record.rows
        work.written = True

    def _take_known(self, work: _Work) -> None:
        """Take over what the journal knows; write the submission down where that is all of it."""
        if not self._journal.has(work.submission, work.notebooks):
            return
        for task in self._tasks_of(work.submission):
            known = self._journal.get(task)
            if known is not None:
                self._reused += 1
                work.results[task.notebook] = task, known
        if work.complete:
            self._write(work)

    def _tasks(self, works: Sequence[_Work]) -> Iterator[Task]:
        """What has to be executed, made when it is its turn."""
        for work in works:
            for task in self._tasks_of(work.submission):
                if task.problem:
                    work.results[task.notebook] = task, task.without_execution()
                elif task.notebook not in work.results:
                    yield task

    def _tasks_of(self, submission: Submission) -> list[Task]:
        from autograder.grading.preparing import tasks_of

        with self._timings.measure("rebuild"):
            return tasks_of(self._directory, submission)

    def _take(self, work: _Work, task: Task, execution: Execution) -> None:
        """Keep a result, and write its submission where it is complete now."""
        self._executed += 1
        self._timings.count(task.cells, execution)
        self._journal.put(task, execution)
        if execution.trouble:
            self._problems.append(f"{task.label} could not be checked: {execution.trouble}")
        work.results[task.notebook] = task, execution
        if work.complete:
            self._write(work)

    def _write(self, work: _Work) -> None:
        rows = tuple(row for pair in work.pairs for row in rows_of(*pair))
        from autograder.grading.writer import NotWritten

        try:
            with self._timings.measure("gradebook"):
                if self._fingerprints.of(work.submission) != work.fingerprint:
                    # Its tasks may have been made of other bytes than those that the record would stand for.
                    name = f"{work.submission.student}/{work.submission.assignment}"
                    raise NotWritten(f"{name} was changed while it was graded: grade it again")
                self._writer.write(work.submission, work.fingerprint, work.pairs, rows)
        except NotWritten as error:
            if is_disk_full(error):
                raise
            self._problem(str(error))
            work.rows = tuple(_without_grade(row) for row in rows)
        else:
            work.rows = rows
            work.written = True
            self._written += 1
            self._make_pages(work)
        work.results.clear()

    def _make_pages(self, work: _Work) -> None:
        """Make the pages of a submission that has none."""
        submission = work.submission
        if not self._feedback or self._records.has_pages(submission, work.notebooks):
            return
        with self._timings.measure("feedback"):
            self._writer.write_feedback(submission)
        if not self._records.has_pages(submission, work.notebooks):
            self._problem(f"feedback for {submission.student}/{submission.assignment} could not be made")

    def _problem(self, text: str) -> None:
        self._problems.append(f"{text} (see {self._directory.state / 'nbgrader.log'})")

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

    def _rows_of(self, student: str, assignment: str, work: _Work | None) -> Sequence[Row]:
        if work is not None and work.rows is not None:
            return work.rows
        state = NOT_SUBMITTED if work is None else NOT_GRADED
        return [
            Row(student, assignment, cell.exercise, 0.0, cell.worth, state)
            for cell in self._cells[assignment]
        ]


def _without_grade(row: Row) -> Row:
    reason = "The result could not be entered into the gradebook; it has zero points there."
    return Row(
        row.student,
        row.assignment,
        row.exercise,
        0.0,
        row.max_score,
        "not_checked",
        "not_written_down",
        reason,
    )


def _check_known(wanted: Sequence[str], known: Sequence[str], what: str) -> None:
    for name in wanted:
        if name not in known:
            raise GradingError(
                f"There is no {what} named {name} here. There is: {', '.join(known) or 'none'}."
            )
