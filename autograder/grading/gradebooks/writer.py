"""Writes the results of a submission to the gradebook, ``autograded/`` and ``feedback/``; the only module that does."""

from __future__ import annotations

import contextlib
import logging
import shutil
import warnings
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from autograder.grading.class_records import Attempt, Entered
from autograder.grading.classes.timestamps import handed_in_at
from autograder.grading.errors import is_disk_full
from autograder.grading.gradebooks import conversion, gradebook
from autograder.grading.gradebooks.gradebook_reading import read_entries
from autograder.grading.returning import feedback
from autograder.grading.table.late_policy import penalties
from autograder.grading.task import scores_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from autograder.execution.cells import Execution
    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.gradebooks.gradebook_reading import SubmissionEntry
    from autograder.grading.reporting.rows import Row
    from autograder.grading.task import Task


class NotWritten(RuntimeError):
    """The points could not be written to the gradebook, or the gradebook does not contain the judge's points."""


class Writer:
    """Writes results into the gradebook, ``autograded/`` and ``feedback/`` of one class.

    Args:
        directory: The class, which this process has locked.
        store: The class's store, which records what was entered.
    """

    def __init__(self, directory: ClassDirectory, store: ClassStore) -> None:
        self._directory = directory
        self._store = store
        self._pages = feedback.FeedbackPages(directory)

    def take_back(self, submissions: Sequence[Submission]) -> None:
        """Set the grades of submissions to zero, and remove their converted notebooks and feedback pages."""
        self._store.forget_entered(submissions)
        for submission in submissions:
            for step in ("autograded", "feedback"):
                _remove(self._folder(step, submission))
        pairs = [(submission.assignment, submission.student) for submission in submissions]
        gradebook.reset(self._directory.gradebook_url, pairs)

    def write(
        self,
        submission: Submission,
        fingerprint: str,
        results: Sequence[tuple[Task, Execution]],
        rows: tuple[Row, ...],
    ) -> None:
        """Convert the submission and enter its grades.

        Args:
            submission: The submission that was executed.
            fingerprint: The hash of all files that influence the results, from :class:`Fingerprints`.
            results: Pairs of a task and its result, one for each notebook of the assignment.
            rows: The results as rows of the report.

        Raises:
            NotWritten: Writing failed, or the gradebook contains wrong points afterwards. The grades were set to zero.
            OSError: The disk is full.
        """
        try:
            with quiet(self._directory.state):
                self._convert_and_enter(submission, results)
            self._verify(submission, results)
        except NotWritten:
            self.take_back([submission])
            raise
        except Exception as error:
            self.take_back([submission])
            raise NotWritten(f"{submission.student}/{submission.assignment}: {error}") from error
        course = results[0][0].course
        entered = Entered(
            fingerprint=fingerprint,
            tasks={task.notebook: task.key() for task, _ in results},
            scores={task.notebook: scores_of(task, execution) for task, execution in results},
            rows=rows,
            course=course,
        )
        attempt = Attempt(datetime.now(tz=UTC), submission.assignment, fingerprint, course, rows)
        is_final = not any(execution.trouble for _, execution in results)
        self._store.enter(submission, attempt, entered if is_final else None)

    def _convert_and_enter(self, submission: Submission, results: Sequence[tuple[Task, Execution]]) -> None:
        """Write the notebooks, then enter the grades.

        The notebooks come first because notebooks without grades do no harm, if the grader is interrupted between the
        two steps.
        """
        folder = self._folder("autograded", submission)
        _remove(folder)
        entries = conversion.convert(self._directory, submission, results, folder)
        url = self._directory.gradebook_url
        has_due_date = gradebook.enter(
            url, submission.assignment, submission.student, entries, handed_in_at(submission.folder)
        )
        if has_due_date:
            self._assign_penalties(submission)

    def enter_time(self, submission: Submission, at: datetime | None) -> None:
        """Enter a new submission time of a graded submission, and the late penalty for it.

        Args:
            submission: A graded submission. Its grades stay unchanged.
            at: The time in UTC; None if the gradebook already has the time, so that only the penalty is computed.
        """
        names = submission.assignment, submission.student
        with quiet(self._directory.state):
            if at is not None:
                gradebook.enter_time(self._directory.gradebook_url, *names, at)
                conversion.write_companions(submission, self._folder("autograded", submission))
            self._assign_penalties(submission)

    def _assign_penalties(self, submission: Submission) -> None:
        url, student = self._directory.gradebook_url, submission.student
        costs = penalties(self._directory.config, student, self._entry(submission))
        gradebook.enter_penalties(url, submission.assignment, student, costs)

    def _entry(self, submission: Submission) -> SubmissionEntry:
        student, assignment = submission.student, submission.assignment
        url = self._directory.gradebook_url
        return read_entries(url, student=student, assignment=assignment)[student, assignment]

    def write_feedback(self, submission: Submission) -> bool:
        """Write the feedback pages of a submission. Return False if that failed; the log then contains the reason.

        Raises:
            OSError: The disk is full.
        """
        notebooks = self._directory.notebooks(submission.assignment)
        with quiet(self._directory.state):
            try:
                self._pages.write(submission, notebooks)
                conversion.write_companions(submission, self._folder("feedback", submission))
            except Exception as error:
                if is_disk_full(error):
                    raise
                logging.getLogger("traitlets").exception("no page for %s", submission.folder)
                return False
        return self._directory.has_pages(submission, notebooks)

    def _verify(self, submission: Submission, results: Sequence[tuple[Task, Execution]]) -> None:
        entry = self._entry(submission)
        for task, execution in results:
            for name, score in scores_of(task, execution).items():
                if entry.judged(task.notebook, name) != score:
                    raise NotWritten(f"{task.label}: the gradebook does not have {score:g} points for {name}")

    def _folder(self, step: str, submission: Submission) -> Path:
        return self._directory.path / step / submission.student / submission.assignment


class _LogFile(logging.FileHandler):
    """A log file that ignores errors when it is written, because the grader itself reports a full disk, once."""

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802  (logging's name)
        """Ignore the error."""


@contextlib.contextmanager
def quiet(state: Path) -> Iterator[None]:
    """During the block, write nbgrader's log to a file of the class, not to the terminal with the progress bar."""
    logger = logging.getLogger("traitlets")
    handler = _LogFile(state / "nbgrader.log", delay=True)
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    before, propagates = list(logger.handlers), logger.propagate
    logger.handlers[:] = [handler]
    logger.propagate = False
    try:
        with warnings.catch_warnings():
            # SQLAlchemy warns about outdated calls in nbgrader 0.9, which was written for an older version.
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.handlers[:] = before
        logger.propagate = propagates
        handler.close()


def _remove(folder: Path) -> None:
    """Remove a folder, even if its files are read-only."""
    if folder.is_dir():
        folder.chmod(0o700)
        shutil.rmtree(folder)
