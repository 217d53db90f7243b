"""Grades a class: rebuilds notebooks, executes them in parallel, and writes the results to the gradebook.

The order of the steps ensures that no failure leaves a wrong grade. First, grades that may be outdated are set to zero
in the gradebook. Then each result is stored in the class's store, and entered into the gradebook when its submission is
complete. So if the run is killed, the gradebook contains only zeros and finished grades, and the next run grades the
rest.

A class may have any size, because the results of a submission are in memory only until they are written.
"""

from __future__ import annotations

import contextlib
import functools
import time
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from autograder.grading.batch_work import AskedFor, Work, due_dates, find_work, without_grade, would_change
from autograder.grading.class_checks import changed_master_warnings, check_configuration, limits_of
from autograder.grading.class_store import ClassStore
from autograder.grading.classes import gradebook_reading
from autograder.grading.classes.class_directory import ClassDirectory, Submission
from autograder.grading.classes.gradebook_reading import SubmissionEntry
from autograder.grading.collecting.submission_times import handed_in_at
from autograder.grading.collecting.submitted_folder import misplaced_files, rename_decomposed_folders
from autograder.grading.course_version import course_version
from autograder.grading.grading_errors import MasterUnusable, is_disk_full
from autograder.grading.reporting.grade_report import GradeReport
from autograder.grading.running import execution_backends
from autograder.grading.running.batch_progress import BatchProgress, Timings, plain_line
from autograder.grading.table.roster import enter_roster, read_roster
from autograder.grading.table.rows import rows_of, write_csv
from autograder.grading.table.weighted_rows import read_what_counts, true_rows
from autograder.grading.tasks.source_points import check_release, read_released
from autograder.grading.tasks.submission_fingerprints import Fingerprints
from environment.installation import COMMAND

# Some modules are imported inside functions, because they import nbgrader, which takes a second.

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.execution.executed_cells import Execution
    from autograder.grading.grading_task import Task
    from autograder.grading.reporting.class_table import Difference
    from autograder.grading.result_writer import Writer
    from autograder.grading.running.execution_backends import Execute
    from autograder.grading.table.roster import Roster


def grade(
    path: Path,
    *,
    assignments: Sequence[str] = (),
    students: Sequence[str] = (),
    sections: Sequence[str] = (),
    jobs: int | None = None,
    again: bool = False,
    feedback: bool = True,
    console: Console | None = None,
    judge: str = "",
    scheduler: str | None = None,
    dry_run: bool = False,
) -> GradeReport:
    """Grade the submissions of a class.

    Args:
        path: The class directory.
        assignments: The assignments to grade; by default all.
        students: The students to grade; by default all.
        sections: The sections to grade. Their students are graded in addition to those in ``students``.
        jobs: The number of notebooks to execute at the same time; by default as many as processors and memory allow.
        again: True to execute every notebook again, even if it has not changed.
        feedback: True to make the feedback pages for students.
        console: The console for the progress; by default standard error.
        judge: The Python class that makes a judge, as ``module:class``; by default the real judge. For tests.
        scheduler: The address of a Dask scheduler whose workers execute the notebooks; by default this machine
            executes them.
        dry_run: True to leave the gradebook unchanged, and report the students whose points would change. But the
            results are stored, so that the next run only has to enter them.

    Returns:
        The report. If a submission could not be graded, the report contains it with zero points and the reason.

    Raises:
        GradingError: The class cannot be graded, for example because another run is grading it, the disk is full, or
            no worker can execute notebooks.
    """
    began = time.monotonic()
    console = console or Console(stderr=True)
    directory = ClassDirectory(Path(path))
    check_configuration(directory)
    if scheduler is None:
        backend = execution_backends.on_this_machine(directory, jobs, judge)
    else:
        execution_backends.check_dask()
        execution_backends.check_address(scheduler)
        tell = functools.partial(plain_line, console)
        backend = execution_backends.on_cluster(directory, scheduler, judge, tell)
    with directory.lock(), contextlib.ExitStack() as stack:
        execution_backends.remove_leftovers(directory)
        roster = read_roster(directory)
        in_sections = roster.of_sections(sections) if sections else ()
        asked = AskedFor(assignments, [*students, *in_sections])
        store = stack.enter_context(ClassStore(directory))
        batch = _Batch(directory, store, console, roster, asked, feedback=feedback, dry_run=dry_run)
        batch.collect()
        batch.plan(again)
        # Find the workers before grades are set to zero: if no worker can execute notebooks, the error leaves the class
        # unchanged.
        execute = stack.enter_context(backend) if batch.unsettled else None
        if not dry_run:
            batch.take_back()
        batch.run(execute)
        return batch.report(time.monotonic() - began)


class _Batch:
    def __init__(
        self,
        directory: ClassDirectory,
        store: ClassStore,
        console: Console,
        roster: Roster,
        asked: AskedFor,
        *,
        feedback: bool,
        dry_run: bool,
    ) -> None:
        self._roster = roster
        self._asked = asked
        self._dry_run = dry_run
        self._directory = directory
        self._store = store
        self._console = console
        self._fingerprints = Fingerprints(directory)
        self._released = released = read_released(directory, store, self._fingerprints)
        self._cells = released.cells
        self._what_counts = read_what_counts(directory, released.cells)
        if not released.cells and released.unusable:
            raise MasterUnusable(next(iter(released.unusable.values())))
        self._problems: list[str] = []
        self._notices: list[str] = []
        self._timings = Timings()
        self._feedback = feedback
        self._began = time.monotonic()
        self._executed = 0
        self._reused = 0
        self._written = 0

    @functools.cached_property
    def _writer(self) -> Writer:
        from autograder.grading.result_writer import Writer

        return Writer(self._directory, self._store)

    def collect(self) -> None:
        """Find the submissions of the class, and the notices about them.

        Raises:
            GradingError: The gradebook does not contain a chosen assignment as it is in the source, or a chosen name
                is not an assignment or a student.
        """
        assignments = self._asked.assignments
        asked = {name: found for name, found in self._cells.items() if not assignments or name in assignments}
        if asked or not assignments:
            check_release(self._directory, asked)
        if not self._dry_run:
            enter_roster(self._directory)
            self._notices += rename_decomposed_folders(self._directory)
        beside, notices = misplaced_files(self._directory)
        self._notices += notices
        for text in changed_master_warnings(self._directory, self._store, assignments or self._cells):
            self._notices.append(text)
            plain_line(self._console, f"note: {text}")
        found = find_work(
            self._directory, self._asked, self._released, self._roster, self._fingerprints, beside
        )
        self._works, self._others, self._refused = found.works, found.others, found.refused
        self._notices += found.notices
        self._notices += self._roster.excused_from_nothing(
            self._directory.assignments(), self._roster.students
        )

    def plan(self, again: bool) -> None:
        """Find out which submissions already have their grades in the gradebook, and which have to be graded."""
        self._entries = gradebook_reading.read_entries(self._directory.gradebook_url)
        self._entered = self._store.entered()
        for work in self._others:
            self._settle(work)
        older = sum(
            work.key in self._entered and self._entered[work.key].course != course_version()
            for work in self._works
        )
        if older:
            self._notices.append(
                f"{older} submissions had been graded with another version of the course. To see whose points have "
                f"changed, type `{COMMAND} compare` after the run, or `{COMMAND} grade --dry-run` before a run"
            )
        if again:
            self._store.forget_results(work.submission for work in self._works)
            return
        for work in self._works:
            self._settle(work)

    @property
    def unsettled(self) -> list[Submission]:
        """The chosen submissions whose grades are not in the gradebook yet."""
        return [work.submission for work in self._works if not work.written]

    def take_back(self) -> None:
        """Set to zero the grades of all submissions that this batch still has to grade."""
        if self.unsettled:
            self._writer.take_back(self.unsettled)

    def run(self, execute: Execute | None) -> None:
        """Execute the tasks without a stored result, and write each submission when all its notebooks have a result.

        Args:
            execute: Executes tasks; None if all grades are already in the gradebook.
        """
        for work in self._works:
            if work.written:
                self._reused += len(work.notebooks)
                if not self._dry_run:
                    self._make_pages(work, self._keep_time(work))
            else:
                self._take_known(work)
        waiting = [work for work in self._works if work.rows is None]
        if not waiting or execute is None:
            return
        works = {work.key: work for work in waiting}
        missing = sum(len(work.notebooks) - len(work.results) for work in waiting)
        longest = limits_of(self._directory).longest
        with BatchProgress(self._console, missing, longest=longest) as progress:
            self._timings.first_started = time.monotonic() - self._began
            results = execute(self._tasks(waiting), lambda task: progress.started(task.label))
            with contextlib.closing(results):
                for done in results:
                    self._timings.last_ended = time.monotonic() - self._began
                    self._take(works[done.task.student, done.task.assignment], done.task, done.execution)
                    progress.finished(done.task.label, failed=bool(done.execution.trouble))
        for work in waiting:
            if work.rows is None and work.complete:
                self._write(work)  # no notebook of this submission had to be executed

    def report(self, seconds: float) -> GradeReport:
        """Return the report on the chosen submissions, and write ``grades.csv``, which contains the whole class."""
        url = self._directory.gradebook_url
        works = {work.key: work for work in (*self._works, *self._others)}
        entries = gradebook_reading.read_entries(url)
        # For a submission that this run did not grade, use the diagnoses from the run that entered its points.
        judged = {key: one.rows for key, one in self._entered.items()}
        judged |= {key: work.rows for key, work in works.items() if work.rows is not None}
        for student, assignment in sorted((entries.keys() & self._entered.keys()) - works.keys()):
            self._notices.append(
                f"{student}/{assignment} is no longer in submitted; its points stay in the gradebook"
            )
        rows = true_rows(
            self._roster.names,
            self._cells,
            judged,
            entries,
            works,
            excused=self._roster.excused,
            what_counts=self._what_counts,
            zone=self._directory.time_zone,
        )
        changes: list[Difference] = []
        if self._dry_run:
            changes = would_change(self._directory, self._works, entries, self._cells)
        else:
            write_csv(self._directory.path / "grades.csv", rows)
            self._store.keep_run(course_version(), rows)
        return GradeReport(
            path=self._directory.path,
            rows=tuple(row for row in rows if self._asked.has(row.student, row.assignment)),
            refused=tuple(one for one in self._refused if self._asked.tells_of(one, self._directory.path)),
            problems=tuple(self._problems),
            notices=tuple(self._notices),
            would_change=tuple(changes) if self._dry_run else None,
            executed=self._executed,
            reused=self._reused,
            written=self._written,
            seconds=seconds,
            timings=self._timings,
            note=execution_backends.UNBOXED_NOTE if self._directory.is_sandbox_off else "",
            gradebook=gradebook_reading.gradebook_file(url),
            due=due_dates(self._directory, self._asked.assignments or self._cells),
        )

    def _settle(self, work: Work) -> None:
        """Mark a submission as written if the gradebook contains the grades of its present files."""
        entered, entry = self._entered.get(work.key), self._entries.get(work.key, SubmissionEntry())
        if entered is None or not entered.is_in(entry):
            return
        if not self._directory.has_converted(work.submission, entered.tasks):
            return
        try:
            handed_in_at(work.submission.folder, believed=entry.handed_in)
        except ValueError:
            return  # the timestamp file is invalid; the writer will reject the submission, with the reason
        if entered.fingerprint != work.fingerprint:
            # The files have changed, but perhaps no cell has: for example, the student saved the notebook again, or
            # another part of the course changed.
            if entered.tasks != {task.notebook: task.key() for task in self._tasks_of(work.submission)}:
                return
            self._store.note_fingerprint(work.submission, work.fingerprint)
        work.rows = entered.rows
        work.shown = entered.shown
        work.written = True

    def _take_known(self, work: Work) -> None:
        """Take the results that earlier runs stored. If none is missing then, enter the submission in the gradebook."""
        known = self._store.results(*work.key)
        for task in self._tasks_of(work.submission) if known else ():
            if (key := task.key()) in known:
                self._reused += 1
                work.results[task.notebook] = task, known[key]
        if work.complete:
            self._write(work)

    def _tasks(self, works: Sequence[Work]) -> Iterator[Task]:
        """Yield the tasks to execute. Each task is made only when the caller asks for it, to save memory."""
        for work in works:
            for task in self._tasks_of(work.submission):
                if task.problem:
                    work.results[task.notebook] = task, task.without_execution()
                elif task.notebook not in work.results:
                    yield task

    def _tasks_of(self, submission: Submission) -> list[Task]:
        from autograder.grading.tasks.task_making import tasks_of

        with self._timings.measure("rebuild"):
            return tasks_of(self._directory, submission)

    def _take(self, work: Work, task: Task, execution: Execution) -> None:
        """Store the result of a task. If the results are now complete, enter the submission in the gradebook."""
        self._executed += 1
        self._timings.count(task.cells, execution)
        execution = self._store.keep(task, execution)
        if execution.trouble:
            self._problems.append(f"{task.label} could not be checked: {execution.trouble}")
        work.results[task.notebook] = task, execution
        if work.complete:
            self._write(work)

    def _write(self, work: Work) -> None:
        rows = tuple(row for pair in work.pairs for row in rows_of(*pair))
        if self._dry_run:
            work.rows = rows
            work.results.clear()
            return
        from autograder.grading.result_writer import NotWritten

        try:
            with self._timings.measure("gradebook"):
                if self._fingerprints.of(work.submission) != work.fingerprint:
                    # The files changed during the run, so the tasks may have been made from files with another
                    # fingerprint.
                    name = f"{work.submission.student}/{work.submission.assignment}"
                    raise NotWritten(f"{name} was changed while it was graded: grade it again")
                self._writer.write(work.submission, work.fingerprint, work.pairs, rows)
        except NotWritten as error:
            if is_disk_full(error):
                raise
            self._problems.append(str(error))
            work.rows = tuple(without_grade(row) for row in rows)
        else:
            work.rows = rows
            work.written = True
            self._written += 1
            self._make_pages(work, gradebook_reading.read_entry(self._directory.gradebook_url, *work.key))
        work.results.clear()

    def _keep_time(self, work: Work) -> SubmissionEntry:
        """Enter a changed submission time into the gradebook, and compute the late penalty again."""
        entry = self._entries.get(work.key, SubmissionEntry())
        at = handed_in_at(work.submission.folder, believed=entry.handed_in)
        moved = at is not None and at != entry.handed_in
        if not (moved or entry.is_late or entry.penalty):
            return entry
        with self._timings.measure("gradebook"):
            self._writer.enter_time(work.submission, at if moved else None)
        return gradebook_reading.read_entry(self._directory.gradebook_url, *work.key)

    def _make_pages(self, work: Work, entry: SubmissionEntry) -> None:
        """Make the feedback pages of a submission, unless it has pages that show what the gradebook contains."""
        submission = work.submission
        if not self._feedback:
            return
        if work.shown == entry.shown() and self._directory.has_pages(submission, work.notebooks):
            return
        with self._timings.measure("feedback"):
            made = self._writer.write_feedback(submission)
        if made:
            self._store.note_shown(submission, entry.shown())
        else:
            log = self._directory.state / "nbgrader.log"
            self._problems.append(
                f"feedback for {submission.student}/{submission.assignment} could not be made (see {log})"
            )
