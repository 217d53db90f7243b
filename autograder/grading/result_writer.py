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
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import msgspec
from nbformat.v4 import rwbase
from nbgrader.preprocessors import LimitOutput
from nbgrader.utils import compute_checksum, determine_grade, is_grade, is_solution, is_task

from autograder.boxes.run_limits import Ended
from autograder.cards.html_rendering import card_bundle
from autograder.execution.executed_cells import Cell, CellCheck, CellRun, CellType, Execution
from autograder.grading.class_records import Attempt
from autograder.grading.classes import gradebook_writing
from autograder.grading.classes.class_dates import ClassDates
from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.classes.gradebook_reading import read_entry
from autograder.grading.classes.gradebook_writing import NotebookEntry
from autograder.grading.grading_errors import is_disk_full
from autograder.grading.grading_task import points, scores_of, unchecked
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.returning import feedback_pages
from autograder.grading.returning.sanitize import harmless_output, make_harmless
from autograder.grading.running import execution_backends
from autograder.grading.table.late_policy import penalties
from autograder.grading.tasks.submission_times import companions, handed_in_at
from autograder.grading.tasks.task_making import LEFT_OUT
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from nbformat import NotebookNode

    from autograder.boxes.run_limits import Limits
    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.classes.gradebook_reading import SubmissionEntry
    from autograder.grading.grading_task import Task
    from autograder.grading.table.rows import Row
    from autograder.grading.tasks.submission_work import Work
    from autograder.verdict import Verdict


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
                _remove(self._folder(step, submission))
        pairs = [(submission.assignment, submission.student) for submission in submissions]
        gradebook_writing.reset(self._directory.gradebook_url, pairs)

    def write(self, work: Work, rows: tuple[Row, ...]) -> None:
        """Convert a submission and enter its grades.

        Args:
            work: The submission, with a result for each notebook. The results are added to the rebuilt notebooks.
            rows: The results as rows of the report.

        Raises:
            NotWritten: Writing failed, or the gradebook contains wrong points afterwards. The grades were set to zero.
            OSError: The disk is full.
        """
        submission = work.submission
        try:
            with quiet(self._directory.state):
                self._convert_and_enter(work)
            # Read the points back, because a wrong grade is worse than none.
            self._verify(work)
        except Exception as error:
            self.take_back([submission])
            if isinstance(error, NotWritten):
                raise
            raise NotWritten(f"{submission.student}/{submission.assignment}: {error}") from error
        tasks = {task.notebook: task.key() for task, _ in work.pairs}
        scores = {task.notebook: scores_of(task, execution) for task, execution in work.pairs}
        now, course = datetime.now(tz=UTC), work.pairs[0][0].course
        attempt = Attempt(
            now, submission.assignment, work.made_from, course, rows, tasks=tasks, scores=scores
        )
        # If the grader itself failed, the attempt is kept, but the submission is not entered as done: it runs again.
        self._store.enter(submission, attempt, is_final=not any(one.trouble for _, one in work.pairs))

    def _convert_and_enter(self, work: Work) -> None:
        """Write the notebooks, then enter the grades.

        The notebooks come first because notebooks without grades do no harm, if the grader is interrupted between the
        two steps.
        """
        submission, url = work.submission, self._directory.gradebook_url
        entries = self._convert(work)
        has_due_date = gradebook_writing.enter(
            url, submission.assignment, submission.student, entries, handed_in_at(submission.folder)
        )
        gradebook_writing.enter_dates(url, self._dates, submission.student)
        if has_due_date:
            self.assign_penalties(submission)

    def _convert(self, work: Work) -> dict[str, NotebookEntry]:
        """Write the notebooks of a submission with their results, and return their entries for the gradebook, by name.

        Raises:
            OSError: A file could not be written.
        """
        folder = self._folder("autograded", work.submission)
        _remove(folder)
        folder.mkdir(parents=True)
        for name, data in self._directory.files(work.submission.assignment).items():
            _write_read_only(folder / name, data)
        _write_companions(work.submission, folder)
        entries = {}
        for task, execution in work.pairs:
            notebook = _with_results(work.rebuilt[task.notebook], task, execution)
            # Before the entry is made, because nbgrader, too, cuts outputs before it computes points from them.
            LimitOutput(config=self._directory.config).preprocess(notebook, {})
            entries[task.notebook] = replace(_notebook_entry(notebook), unchecked=unchecked(task, execution))
            _write_read_only(folder / f"{task.notebook}{SUFFIX}", _notebook_text(notebook))
        return entries

    def assign_penalties(self, submission: Submission) -> None:
        """Enter the late penalty of a submission into the gradebook."""
        with quiet(self._directory.state):
            url, config = self._directory.gradebook_url, self._directory.config
            costs = penalties(config, submission.student, self._entry(submission))
            gradebook_writing.enter_penalties(url, submission.assignment, submission.student, costs)

    def _entry(self, submission: Submission) -> SubmissionEntry:
        return read_entry(self._directory.gradebook_url, submission.student, submission.assignment)

    def write_feedback(self, submission: Submission) -> bool:
        """Write the feedback pages of a submission. Return False if that failed; the log then contains the reason.

        Raises:
            OSError: The disk is full.
        """
        notebooks = self._directory.notebooks(submission.assignment)
        with quiet(self._directory.state):
            try:
                self._pages.write(submission, notebooks)
                _write_companions(submission, self._folder("feedback", submission))
            except Exception as error:
                if is_disk_full(error):
                    raise
                logging.getLogger("traitlets").exception("no page for %s", submission.folder)
                return False
        return self._directory.has_pages(submission, notebooks)

    def _verify(self, work: Work) -> None:
        entry = self._entry(work.submission)
        for task, execution in work.pairs:
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


_READ_ONLY = 0o444


def _write_companions(submission: Submission, folder: Path) -> None:
    """Copy the files that nbgrader keeps about a submission (its timestamp and its secret) into a folder.

    Raises:
        OSError: A file could not be written.
    """
    for name, data in companions(submission.folder).items():
        _write_read_only(folder / name, data)


def _notebook_text(notebook: NotebookNode) -> bytes:
    """Return the JSON text of a notebook, equal to nbformat's but made faster. The argument is changed."""
    split: Any = rwbase.split_lines
    strip: Any = rwbase.strip_transient
    encoded = msgspec.json.encode(strip(split(notebook)), order="sorted")
    return msgspec.json.format(encoded, indent=1) + b"\n"


def _notebook_entry(notebook: NotebookNode) -> NotebookEntry:
    """Return the gradebook entry for a notebook, equal to the one that nbgrader's SaveAutoGrades would make."""
    scores: dict[str, float | None] = {}
    comments: dict[str, str | None] = {}
    for cell in notebook.cells:
        if is_grade(cell):
            scores[cell.metadata.nbgrader.grade_id] = determine_grade(cell)[0]
        if is_solution(cell) or is_task(cell):
            untouched = cell.metadata.nbgrader.get("checksum") == compute_checksum(cell)
            no_answer = untouched and not is_task(cell)
            comments[cell.metadata.nbgrader.grade_id] = "No response." if no_answer else None
    return NotebookEntry(scores, comments)


def _write_read_only(path: Path, data: bytes) -> None:
    write_whole(path, data)
    path.chmod(_READ_ONLY)


def _with_results(nb: NotebookNode, task: Task, execution: Execution) -> NotebookNode:
    """Return a rebuilt notebook with the outputs of its cells, which for a check cell are the card and the points."""
    count = 0
    for index, (node, cell) in enumerate(zip(nb.cells, task.cells, strict=True)):
        if node.cell_type != "code":
            continue
        run = execution.cells[index] if index < len(execution.cells) else CellRun(Ended.NOT_RUN)
        if run.ended is not Ended.NOT_RUN:
            count += 1
            node.execution_count = count
        if cell.check is not None:
            node.outputs = _graded_outputs(cell.check, execution.verdicts[index], run.outputs)
        else:
            node.outputs = [nbformat_nodes.output(**output) for output in run.outputs]
            node.outputs += _remark(node, cell, run, task.limits) if execution.cells else []
    # Scripts in outputs are removed here, because nbgrader's formgrader shows notebooks of `autograded/` unchanged.
    make_harmless(nb, {index for index, cell in enumerate(task.cells) if cell.own})
    nb.cells = list(_with_rubrics(nb.cells))
    if not task.boxed:
        nb.cells.insert(0, nbformat_nodes.cell(CellType.MARKDOWN, f"**{execution_backends.UNBOXED_NOTE}**"))
    return nb


def _with_rubrics(cells: Sequence[NotebookNode]) -> Iterator[NotebookNode]:
    """Yield the cells. Below each answer that a person grades, add a cell with the instructor's notes for grading."""
    for cell in cells:
        notes = cell.metadata.pop("autograder", {})
        yield cell
        if notes.get("rubric"):
            text = f"**How this answer is graded**\n\n{notes['rubric']}"
            rubric_cell = nbformat_nodes.cell(CellType.MARKDOWN, text, f"rubric-{cell.id}"[:64])
            if notes["pictures"]:
                rubric_cell["attachments"] = notes["pictures"]
            yield rubric_cell


def _graded_outputs(
    check: CellCheck, verdict: Verdict, outputs: Sequence[Mapping[str, Any]]
) -> list[NotebookNode]:
    """Return the outputs of a graded cell: the card, the output of its tests, and last the points, for nbgrader."""
    score = points(check, verdict)
    card = nbformat_nodes.output(output_type="display_data", data=card_bundle(verdict), metadata={})
    return [
        *([card, *_of_tests(outputs)] if check.asserts else [card]),
        nbformat_nodes.output(
            output_type="execute_result",
            data={"text/plain": f"{score:.17g}"},
            metadata={},
            execution_count=None,
        ),
    ]


def _of_tests(outputs: Sequence[Mapping[str, Any]]) -> Iterator[NotebookNode]:
    """Yield the output and errors of a cell's tests as plain printed text, so that nbgrader ignores them.

    Otherwise, nbgrader would give zero points for an error, and take the cell's first value as the points.
    """
    for one in outputs:
        if one["output_type"] == "error":
            yield harmless_output(_printed("\n".join(one["traceback"]) or f"{one['ename']}: {one['evalue']}"))
        elif one["output_type"] == "stream":
            yield harmless_output(_printed(one["text"]))
        elif one["output_type"] == "display_data":
            yield harmless_output(nbformat_nodes.output(**one))


def _printed(text: str) -> NotebookNode:
    return nbformat_nodes.output(output_type="stream", name="stdout", text=text)


def _remark(node: NotebookNode, cell: Cell, run: CellRun, limits: Limits) -> list[NotebookNode]:
    words = {
        Ended.TIMED_OUT: f"[stopped: the cell had not ended after {run.seconds:.0f} s]",
        Ended.KERNEL_DIED: "[the kernel ended in this cell]",
        Ended.OUT_OF_MEMORY: f"[stopped: more than {limits.memory_bytes / 1e9:g} GB of memory]",
        Ended.OUT_OF_CPU: f"[stopped: more than {limits.cpu_seconds:g} s of processor time]",
        Ended.TOO_MANY_PROCESSES: f"[stopped: more than {limits.processes} processes and threads]",
        Ended.TOO_MUCH_OUTPUT: f"[stopped: more than {limits.flood_bytes / 1e6:g} MB of output]",
        Ended.NOT_RUN: "[this cell was not run]",
    }
    text = words.get(run.ended) if cell.source.strip() else LEFT_OUT if node.source.strip() else None
    return [_printed(f"{text}\n")] if text else []
