"""Writes the results of submissions into a class: notebooks in ``autograded/``, grades, and feedback pages.

The notebooks and the gradebook entries are the same as those of ``nbgrader autograde``. But this module takes a
twentieth of the time, because nbgrader reads, validates and writes every notebook twice, and opens the gradebook a
dozen times.
"""

from __future__ import annotations

import contextlib
import logging
import shutil
import warnings
from typing import TYPE_CHECKING

from autograder.grading.classes import gradebook_writing
from autograder.grading.classes.class_dates import ClassDates
from autograder.grading.classes.gradebook_reading import read_entry
from autograder.grading.grading_errors import is_disk_full
from autograder.grading.returning import feedback_pages
from autograder.grading.table.late_policy import penalties
from autograder.grading.tasks.submission_times import companions
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.classes.gradebook_reading import SubmissionEntry
    from autograder.grading.tasks.graded_notebooks import Converted


class NotWritten(RuntimeError):
    """The points could not be written to the gradebook, or the gradebook does not contain the judge's points."""


class Writer:
    """Writes results into the gradebook, ``autograded/`` and ``feedback/`` of one class.

    Args:
        directory: The class, which this process has locked.
        store: The class's store, which records what was entered.
        dates: The due dates and extensions of ``class.toml``.
    """

    def __init__(self, directory: ClassDirectory, store: ClassStore, dates: ClassDates | None = None) -> None:
        self._dates = dates or ClassDates()
        self._directory = directory
        self._store = store
        self._pages = feedback_pages.FeedbackPages(directory)

    def take_back(self, submissions: Sequence[Submission]) -> None:
        """Set the grades of submissions to zero, and remove their converted notebooks and feedback pages."""
        self._store.forget_entered(submissions)
        for submission in submissions:
            for step in ("autograded", "feedback"):
                _remove(self._directory.folder(step, submission))
        gradebook_writing.reset(self._directory.gradebook_url, submissions)

    @contextlib.contextmanager
    def all_or_nothing(self, submission: Submission) -> Iterator[None]:
        """If the block fails, set the grades of a submission to zero.

        Raises:
            NotWritten: The block failed.
        """
        try:
            with quiet(self._directory.state):
                yield
        except Exception as error:
            self.take_back([submission])
            if isinstance(error, NotWritten):
                raise
            raise NotWritten(f"{submission.label}: {error}") from error

    def write(self, converted: Converted) -> SubmissionEntry:
        """Write the notebooks of a submission, then enter its grades. Return its entry in the gradebook.

        The notebooks come first because notebooks without grades do no harm, if the grader is interrupted between the
        two steps.

        Raises:
            NotWritten: The gradebook contains wrong points afterwards.
            OSError: The disk is full.
        """
        submission, attempt, url = converted.submission, converted.attempt, self._directory.gradebook_url
        folder = self._directory.folder("autograded", submission)
        _remove(folder)
        folder.mkdir(parents=True)
        for name, data in converted.files.items():
            _write_read_only(folder / name, data)
        has_due_date = gradebook_writing.enter(url, submission, converted.entries, converted.handed_in)
        gradebook_writing.enter_dates(url, self._dates, submission.student)
        # Read the points back, because a wrong grade is worse than none.
        entry = self.assign_penalties(submission) if has_due_date else read_entry(url, *submission.key)
        if missing := attempt.missing_in(entry):
            raise NotWritten(f"{submission.label}: the gradebook does not have {missing[0]}")
        self._store.enter(submission, attempt, is_final=converted.is_final)
        return entry

    def assign_penalties(self, submission: Submission) -> SubmissionEntry:
        """Enter the late penalty of a submission into the gradebook, and return the submission's entry there."""
        with quiet(self._directory.state):
            url, config = self._directory.gradebook_url, self._directory.config
            costs = penalties(config, submission.student, read_entry(url, *submission.key))
            gradebook_writing.enter_penalties(url, submission.assignment, submission.student, costs)
            return read_entry(url, *submission.key)

    def write_feedback(self, submission: Submission) -> bool:
        """Write the feedback pages of a submission. Return False if that failed; the log then contains the reason.

        Raises:
            OSError: The disk is full.
        """
        notebooks = self._directory.notebooks(submission.assignment)
        with quiet(self._directory.state):
            try:
                self._pages.write(submission, notebooks)
                for name, data in companions(submission.folder).items():
                    _write_read_only(self._directory.folder("feedback", submission) / name, data)
            except Exception as error:
                if is_disk_full(error):
                    raise
                logging.getLogger("traitlets").exception("no page for %s", submission.folder)
                return False
        return self._directory.has_pages(submission, notebooks)


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


_READ_ONLY = 0o444


def _write_read_only(path: Path, data: bytes) -> None:
    write_whole(path, data)
    path.chmod(_READ_ONLY)
