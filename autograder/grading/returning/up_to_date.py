"""The return of a run to the students: the time of handing in, what being late costs, and the pages that say it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.grading.classes.timestamps import handed_in_at
from autograder.grading.entering.gradebook_reading import SubmissionEntry, read_entries

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.entering.writer import Writer
    from autograder.grading.running.timings import Timings
    from autograder.grading.work import Work


class UpToDate:
    """Keeps times and pages of graded submissions up to date.

    Args:
        directory: The class.
        store: The store of the class, where it is noted what the pages say.
        writer: Gives the one who writes into the gradebook; called only where there is something to write.
        timings: Counts the time that this takes.
        problem: Told where a page could not be made.
        feedback: Whether pages are made at all.
    """

    def __init__(
        self,
        directory: ClassDirectory,
        store: ClassStore,
        writer: Callable[[], Writer],
        timings: Timings,
        problem: Callable[[str], None],
        *,
        feedback: bool,
    ) -> None:
        self._directory = directory
        self._store = store
        self._writer = writer
        self._timings = timings
        self._problem = problem
        self._feedback = feedback

    def bring(self, work: Work, entry: SubmissionEntry) -> None:
        """Bring a submission up to date that was in the gradebook before this run, as ``entry``."""
        self._make_pages(work, self._keep_time(work, entry))

    def bring_graded(self, work: Work) -> None:
        """Bring a submission up to date that was entered just now, with its time."""
        self._make_pages(work, self._read(work))

    def _keep_time(self, work: Work, entry: SubmissionEntry) -> SubmissionEntry:
        """Enter a changed time of handing in, or a changed due date, and what being late costs now."""
        at = handed_in_at(work.submission.folder, believed=entry.handed_in)
        moved = at is not None and at != entry.handed_in
        if not (moved or entry.is_late or entry.penalty):
            return entry
        with self._timings.measure("gradebook"):
            self._writer().enter_time(work.submission, at if moved else None)
        return self._read(work)

    def _read(self, work: Work) -> SubmissionEntry:
        student, assignment = work.key
        entries = read_entries(self._directory.gradebook_url, student=student, assignment=assignment)
        return entries.get(work.key, SubmissionEntry())

    def _make_pages(self, work: Work, entry: SubmissionEntry) -> None:
        """Make the pages of a submission that has none, or whose pages say what the gradebook said before."""
        submission = work.submission
        if not self._feedback:
            return
        if work.shown == entry.shown() and self._directory.has_pages(submission, work.notebooks):
            return
        with self._timings.measure("feedback"):
            made = self._writer().write_feedback(submission)
        if made:
            self._store.note_shown(submission, entry.shown())
        else:
            log = self._directory.state / "nbgrader.log"
            self._problem(
                f"feedback for {submission.student}/{submission.assignment} could not be made (see {log})"
            )
