"""The steps of a run over a class: :data:`autograder.grading.batch.FLOW` lists them in their order."""

from __future__ import annotations

import contextlib
import functools
import itertools
import time
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.grading.batch_work import (
    due_dates,
    find_work,
    forget_unneeded_documents,
    moved_points,
    unlisted_notice,
    without_grade,
    would_change,
)
from autograder.grading.class_checks import changed_master_warnings
from autograder.grading.classes import gradebook_reading, gradebook_writing
from autograder.grading.classes.gradebook_reading import SubmissionEntry
from autograder.grading.collecting.submitted_folder import misplaced_files, rename_decomposed_folders
from autograder.grading.grading_errors import MasterUnusable, is_disk_full
from autograder.grading.reporting.grade_report import GradeReport
from autograder.grading.running import execution_backends
from autograder.grading.running.batch_progress import BatchProgress, plain_line
from autograder.grading.table.rows import rows_of, write_csv
from autograder.grading.table.student_list import enter_roster
from autograder.grading.table.weighted_rows import read_what_counts, true_rows
from autograder.grading.tasks.class_drawings import DRAWINGS, ClassDrawings, all_drawings, drawings_of
from autograder.grading.tasks.date_reading import read_class_dates
from autograder.grading.tasks.fallen_points import FallenPoints
from autograder.grading.tasks.kept_results import KeptResults
from autograder.grading.tasks.result_keys import ResultKeys
from autograder.grading.tasks.source_points import check_release, read_released
from autograder.grading.tasks.submission_work import Entered, MadeTask, Result

# Some modules are imported inside functions, because they import nbgrader, which takes a second.

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from rich.console import Console

    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.grading_task import Task
    from autograder.grading.reporting.class_table import Difference
    from autograder.grading.result_writer import Writer
    from autograder.grading.running.execution_backends import Execute
    from autograder.grading.table.roster import Roster
    from autograder.grading.table.rows import Row
    from autograder.grading.tasks.asked_for import AskedFor
    from autograder.grading.tasks.class_drawings import Drawing
    from autograder.grading.tasks.submission_work import Work


class Batch:
    """A run over a class. Its public methods are the steps of :data:`autograder.grading.batch.FLOW`.

    A step gets what the step before it returned, or yields one by one.

    Args:
        directory: The class, which this process has locked.
        asked: The choices of the instructor for the run.
        backend: Finds the workers that execute tasks.
        here: Makes this machine execute tasks. The solution runs nowhere else, because it decides all grades.
        stack: Ends what the run began.

    Raises:
        MasterUnusable: No assignment of the class can be graded.
    """

    def __init__(
        self,
        directory: ClassDirectory,
        store: ClassStore,
        console: Console,
        roster: Roster,
        asked: AskedFor,
        backend: contextlib.AbstractContextManager[Execute],
        here: contextlib.AbstractContextManager[Execute],
        stack: contextlib.ExitStack,
    ) -> None:
        self._began = time.monotonic()
        self._backend, self._here, self._stack = backend, here, stack
        self._drawings = ClassDrawings(directory)
        self._directory, self._store, self._console = directory, store, console
        self._roster, self._asked = roster, asked
        self._keys = ResultKeys(directory)
        # Read before any step, so that a class without a usable source is refused while it is unchanged.
        self._released = released = read_released(directory, store, self._keys)
        self._cells = released.cells
        self._dates = read_class_dates(directory, roster)
        self._what_counts = read_what_counts(directory, released.cells)
        if not released.cells and released.unusable:
            raise MasterUnusable(next(iter(released.unusable.values())))
        self._problems: list[str] = []
        self._notices: list[str] = []
        self._timings: dict[str, float] = {}
        self._reused = 0
        self._written = 0
        self._moved: list[Difference] = []
        self._kept = KeptResults(store, FallenPoints(directory.state), asked)

    @functools.cached_property
    def _writer(self) -> Writer:
        from autograder.grading.result_writer import Writer

        return Writer(self._directory, self._store, self._dates)

    def note(self, sentences: Iterable[str]) -> None:
        """Add sentences for the instructor to the report of the run."""
        self._notices += sentences

    def find(self, _: Iterable[Work]) -> list[Work]:
        """Return the chosen submissions of the class, and note what has to be said about others.

        Raises:
            GradingError: The gradebook does not contain a chosen assignment as it is in the source, or a chosen name
                is not an assignment or a student.
        """
        assignments = self._asked.assignments
        asked = {name: cells for name, cells in self._cells.items() if not assignments or name in assignments}
        # An assignment that cannot be graded has no cells; `find_work` says so, more exactly than the gradebook.
        if asked or not assignments:
            check_release(self._directory, asked)
        # A dry run changes neither the gradebook nor the folder ``submitted``.
        if not self._asked.dry_run:
            enter_roster(self._directory)
            gradebook_writing.enter_dates(self._directory.gradebook_url, self._dates)
            self._notices += rename_decomposed_folders(self._directory)
        beside, notices = misplaced_files(self._directory)
        self._notices += notices
        for text in changed_master_warnings(self._directory, self._store, assignments or self._cells):
            self._notices.append(text)
            plain_line(self._console, f"note: {text}")
        work = find_work(self._directory, self._asked, self._released, self._roster, self._keys, beside)
        self._works, self._others, self._refused = work.works, work.others, work.refused
        self._notices += work.notices
        return work.works

    def settle(self, works: list[Work]) -> list[Work]:
        """Return the submissions that have to be graded: the gradebook lacks the grades of their present files."""
        self._entries = gradebook_reading.read_entries(self._directory.gradebook_url)
        self._entered = self._store.entered()
        unlisted = [work for work in self._others if self._asked.has(*work.key) and not self._settled(work)]
        self._notices += unlisted_notice(unlisted)
        settled = {work.key: None if self._is_asked_again(work) else self._settled(work) for work in works}
        self._done = [entered for entered in settled.values() if entered]
        self._reused += sum(len(one.work.notebooks) for one in self._done)
        waiting = [work for work in works if settled[work.key] is None]
        self._kept.expect(waiting)
        return waiting

    def _is_asked_again(self, work: Work) -> bool:
        return self._asked.again or (self._asked.lower == "yes" and self._kept.fallen.has(*work.key))

    def _settled(self, work: Work) -> Entered | None:
        """Return a submission as entered if the gradebook contains the grades of its present files; otherwise None."""
        entered, entry = self._entered.get(work.key), self._entries.get(work.key, SubmissionEntry())
        if entered is None or entered.made_from != work.made_from or entered.missing_in(entry):
            return None
        if not self._directory.has_converted(work, entered.tasks):
            return None
        return Entered(work, entered.rows, entry, entered.shown)

    def find_workers(self, works: list[Work]) -> list[Work]:
        """Find out who executes tasks, if something has to be graded.

        Raises:
            GradingError: Nothing can be executed.
        """
        if works:
            self._execute: Execute = self._stack.enter_context(self._backend)
        return works

    def draw(self, works: list[Work]) -> list[Work]:
        """Record the solution in those drawings of the class that the submissions need and that are not recorded.

        A drawing that cannot be recorded is a problem. The exercise then cannot be checked.

        Raises:
            GradingError: Nothing can be executed on this machine.
        """
        exercises = {name: [cell.exercise for cell in cells] for name, cells in self._cells.items()}
        count = Counter(work.assignment for work in works)
        needed: set[Drawing] = set()
        for work in works:
            drawings = all_drawings(exercises[work.assignment])
            if count[work.assignment] < DRAWINGS and self._drawings.missing(drawings):
                drawings = [one for made in self._tasks_of(work) for one in drawings_of(made.task)]
            needed.update(drawings)
        if missing := self._drawings.missing(needed):
            plain_line(self._console, f"running the solution in this class's inputs, {len(missing)} times")
            # On a cluster, this machine executes nothing else, so it is prepared only now.
            own = self._execute if self._backend is self._here else self._stack.enter_context(self._here)
            with BatchProgress(self._console, len(missing), doing="recording", did="recorded") as progress:
                reasons = self._drawings.record(missing, own, progress)
            self._problems += (
                f"{exercise} cannot be checked, because its solution was not recorded: {why}"
                for exercise, why in reasons.items()
            )
        return works

    def take_back(self, works: list[Work]) -> list[Work]:
        """Set to zero the grades of the submissions that have to be graded."""
        if works and not self._asked.dry_run:
            self._writer.take_back(works)
        return works

    def make_tasks(self, works: list[Work]) -> Iterator[MadeTask]:
        """Yield the notebooks as tasks, first those with a stored result, which do not wait for the others.

        Each task to execute is made only when a worker is free, to save memory.
        """
        stored = set()
        for work in works:
            results = {} if self._is_asked_again(work) else self._store.results(*work.key)
            for made in self._tasks_of(work) if results else ():
                if (key := made.task.key()) in results:
                    stored.add(made.task.label)
                    yield Result(work, made.task, made.rebuilt, results[key])
        self._reused += len(stored)
        self._missing = sum(len(work.notebooks) for work in works) - len(stored)
        for work in works:
            for made in self._tasks_of(work, stored):
                task = made.task
                yield Result(work, task, made.rebuilt, task.without_execution()) if task.problem else made

    def execute(self, made: Iterable[MadeTask]) -> Iterator[Result]:
        """Execute the tasks without a result, and yield each result as soon as it is there."""
        made = iter(made)
        for one in made:
            if isinstance(one, Result):
                yield one
            else:
                yield from self._executed(itertools.chain([one], made))

    def _executed(self, made: Iterable[MadeTask]) -> Iterator[Result]:
        under_way: dict[str, MadeTask] = {}
        unreadable: list[Result] = []

        def tasks() -> Iterator[Task]:
            for one in made:
                if isinstance(one, Result):
                    unreadable.append(one)
                else:
                    under_way[one.task.label] = one
                    yield one.task

        with BatchProgress(self._console, self._missing) as progress:
            self._timings["first_started"] = time.monotonic() - self._began
            dones = self._execute(tasks(), on_start=lambda task: progress.started(task.label))
            with contextlib.closing(dones):
                for done in dones:
                    self._timings["last_ended"] = time.monotonic() - self._began
                    made_of = under_way.pop(done.task.label)
                    yield Result(made_of.work, done.task, made_of.rebuilt, done.execution, is_new=True)
                    progress.finished(done.task.label, failed=bool(done.execution.trouble))
        yield from unreadable

    def keep(self, results: Iterable[Result]) -> Iterator[list[Result]]:
        """Store each new result, and yield the results of each submission that has all, by notebook in their order."""
        incomplete: dict[tuple[str, str], dict[str, Result]] = {}
        for result in results:
            work = result.work
            of_work = incomplete.setdefault(work.key, {})
            of_work[result.task.notebook] = self._noted(result) if result.is_new else result
            if len(of_work) == len(work.notebooks):
                del incomplete[work.key]
                yield [of_work[notebook] for notebook in work.notebooks]

    def enter(self, graded: Iterable[Sequence[Result]]) -> Iterator[Entered]:
        """Enter submissions into the gradebook and ``autograded``, and yield all chosen ones; in a dry run, enter none.

        Submissions whose grades were in the gradebook already come first.
        """
        for entered in self._done:
            yield self._penalized(entered)
        for results in graded:
            rows = tuple(row for result in results for row in rows_of(result.task, result.execution))
            work = results[0].work
            yield Entered(work, rows, None) if self._asked.dry_run else self._write(work, results, rows)

    def show(self, submissions: Iterable[Entered]) -> Iterator[Entered]:
        """Make the feedback pages of submissions, except of those whose pages show what the gradebook contains."""
        for one in submissions:
            if self._asked.feedback and not self._asked.dry_run and one.entry is not None:
                has_pages = self._directory.has_pages(one.work, one.work.notebooks)
                if not (has_pages and one.shown == one.entry.shown()):
                    self._make_pages(one.work, one.entry)
            yield one

    def report(self, submissions: Iterable[Entered]) -> GradeReport:
        """Run the earlier steps on all submissions, return the report on them, and write ``grades.csv``.

        ``grades.csv`` contains the whole class.
        """
        entered = {one.work.key: one for one in submissions}
        url = self._directory.gradebook_url
        handed_in = {work.key for work in (*self._works, *self._others)}
        entries = gradebook_reading.read_entries(url)
        # For a submission that this run did not grade, use the diagnoses from the run that entered its points.
        judged = {key: one.rows for key, one in self._entered.items()}
        judged |= {key: one.rows for key, one in entered.items()}
        for student, assignment in sorted((entries.keys() & self._entered.keys()) - handed_in):
            self._notices.append(
                f"{student}/{assignment} is no longer in submitted; its points stay in the gradebook."
            )
        counts, zone = self._what_counts, self._directory.time_zone
        rows = true_rows(self._roster, self._cells, judged, entries, handed_in, what_counts=counts, zone=zone)
        self._notices += self._roster.notices(self._directory.assignments(), entries, self._roster.students)
        changes = None
        if self._asked.dry_run:
            in_order = [entered[work.key] for work in self._works]
            changes = tuple(would_change(self._directory, in_order, entries, self._cells, self._dates))
        else:
            write_csv(self._directory.path / "grades.csv", rows)
            if self._kept.run_again:
                forget_unneeded_documents(self._directory)
        return GradeReport(
            path=self._directory.path,
            rows=tuple(row for row in rows if self._asked.has(row.student, row.assignment)),
            refused=tuple(one for one in self._refused if self._asked.tells_of(one, self._directory.path)),
            problems=tuple(self._problems),
            notices=tuple(self._notices),
            would_change=changes,
            executed=self._kept.run_again.total(),
            run_again={why: count for why, count in self._kept.run_again.items() if why},
            moved=tuple(self._moved),
            fallen=tuple(
                one for one in self._kept.fallen.results if self._asked.has(one.student, one.assignment)
            ),
            reused=self._reused,
            written=self._written,
            seconds=time.monotonic() - self._began,
            timings=self._timings,
            note=execution_backends.UNBOXED_NOTE if self._directory.is_sandbox_off else "",
            gradebook=gradebook_reading.gradebook_file(url),
            due=due_dates(self._directory, self._asked.assignments or self._cells),
        )

    def _noted(self, result: Result) -> Result:
        """Store the result of an executed notebook, and return the result that counts."""
        kept = self._kept.keep(result)
        if kept.execution.trouble:
            self._problems.append(f"{kept.task.label} could not be checked: {kept.execution.trouble}")
        return kept

    def _tasks_of(self, work: Work, without: Collection[str] = ()) -> Iterator[MadeTask]:
        """Yield a task for each notebook of a submission, except those with the labels ``without``."""
        from autograder.grading.tasks.task_making import task_of

        for notebook in work.notebooks:
            if f"{work.label}/{notebook}" not in without:
                task, rebuilt = task_of(self._directory, work, notebook)
                yield MadeTask(work, replace(task, drawings=self._drawings.of(task)), rebuilt)

    def _write(self, work: Work, results: Sequence[Result], rows: tuple[Row, ...]) -> Entered:
        """Write the results of a submission; if that fails, the gradebook has zero points for it."""
        from autograder.grading.result_writer import NotWritten
        from autograder.grading.tasks.graded_notebooks import convert

        try:
            with self._writer.all_or_nothing(work):
                if self._keys.of(work) != work.made_from:
                    # The files changed during the run, so the tasks may have been made from other files.
                    raise NotWritten(f"{work.label} was changed while it was graded: grade it again")
                entry = self._writer.write(convert(self._directory, results, rows))
        except NotWritten as error:
            if is_disk_full(error):
                raise
            self._problems.append(str(error))
            return Entered(work, tuple(without_grade(row) for row in rows), None)
        self._notices += self._kept.worse(work, rows)
        self._moved += moved_points(work, rows, self._entered.get(work.key))
        if self._asked.lower == "yes":
            self._kept.fallen.forget(lambda *key: key == work.key)
        self._written += 1
        return Entered(work, rows, entry)

    def _penalized(self, entered: Entered) -> Entered:
        """Compute the late penalty of an entered submission again, and return the submission with it."""
        entry = entered.entry
        if self._asked.dry_run or entry is None or not (entry.is_late or entry.penalty):
            return entered
        return replace(entered, entry=self._writer.assign_penalties(entered.work))

    def _make_pages(self, work: Work, entry: SubmissionEntry) -> None:
        if self._writer.write_feedback(work):
            self._store.note_shown(work, entry.shown())
        else:
            log = self._directory.state / "nbgrader.log"
            self._problems.append(f"feedback for {work.label} could not be made (see {log})")
