"""The one writer into gradebook, ``autograded/`` and ``feedback/``; everything in it fails closed."""

from __future__ import annotations

import contextlib
import logging
import shutil
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
from nbgrader.converters import Autograde, BaseConverter, GenerateFeedback, NbGraderException
from nbgrader.coursedir import CourseDirectory
from nbgrader.preprocessors import AssignLatePenalties
from traitlets.config import Config

from autograder.grading import conversion, feedback, gradebook, nodes
from autograder.grading.class_directory import SUFFIX, ClassDirectory, Submission
from autograder.grading.errors import is_disk_full
from autograder.grading.journal import write_whole
from autograder.grading.points import scores_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from autograder.boxes.execution import Execution
    from autograder.grading.task import Task


@dataclass(frozen=True)
class Written:
    """What a finished submission left in the gradebook.

    Attributes:
        keys: The task of each notebook.
        scores: The points of each check cell, by notebook and grade_id.
    """

    keys: dict[str, str]
    scores: dict[str, dict[str, float]]


class NotWritten(RuntimeError):
    """The gradebook does not say what the judge said; the message says where."""


class Writer:
    """Writes results into gradebook, ``autograded/`` and ``feedback/`` of one class.

    Args:
        directory: The class, locked by this process.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory
        self._records = directory.state / "written"
        self._pages = feedback.FeedbackPages(directory)

    def take_back(self, submissions: Sequence[Submission]) -> None:
        """Remove what an earlier run left of these submissions: grades, converted notebooks, feedback."""
        for submission in submissions:
            self._record_path(submission).unlink(missing_ok=True)
            for step in ("autograded", "feedback"):
                _remove(self._folder(step, submission))
        pairs = [(submission.assignment, submission.student) for submission in submissions]
        gradebook.reset(self._directory.gradebook_url, pairs)

    def is_written(
        self, submission: Submission, tasks: Sequence[Task], in_gradebook: Mapping[str, gradebook.Scores]
    ) -> bool:
        """Whether gradebook and folders already hold exactly the results of these tasks.

        Args:
            submission: The submission.
            tasks: Its tasks.
            in_gradebook: The scores that the gradebook has for it now, by notebook.
        """
        try:
            record = msgspec.json.decode(self._record_path(submission).read_bytes(), type=Written)
        except (OSError, msgspec.MsgspecError):
            return False
        if record.keys != {task.notebook: task.key() for task in tasks}:
            return False
        files = (self._folder("autograded", submission) / f"{task.notebook}{SUFFIX}" for task in tasks)
        return all(file.is_file() for file in files) and all(
            in_gradebook.get(notebook, {}).get(name) == score
            for notebook, scores in record.scores.items()
            for name, score in scores.items()
        )

    def write(self, submission: Submission, results: Sequence[tuple[Task, Execution]]) -> None:
        """Convert the submission and enter its grades.

        Raises:
            NotWritten: That failed, or the gradebook then says something else. The grades are zero then.
            OSError: There is no room on the disk.
        """
        try:
            with quiet(self._directory.state):
                if conversion.is_usual(self._directory.config):
                    self._convert_and_enter(submission, results)
                else:
                    _Autograde(submission, results, self._course()).convert()
            self._verify(submission, results)
        except NotWritten:
            self.take_back([submission])
            raise
        except Exception as error:
            self.take_back([submission])
            raise NotWritten(f"{submission.student}/{submission.assignment}: {error}") from error
        record = Written(
            keys={task.notebook: task.key() for task, _ in results},
            scores={task.notebook: scores_of(task, execution) for task, execution in results},
        )
        write_whole(self._record_path(submission), msgspec.json.encode(record))

    def _convert_and_enter(self, submission: Submission, results: Sequence[tuple[Task, Execution]]) -> None:
        """What nbgrader's conversion does. Notebooks first: without grades they are only files."""
        folder = self._folder("autograded", submission)
        _remove(folder)
        entries = conversion.convert(self._directory, submission, results, folder)
        url = self._directory.gradebook_url
        has_due_date = gradebook.enter(
            url, submission.assignment, submission.student, entries, conversion.handed_in_at(submission)
        )
        if has_due_date:
            for task, _ in results:
                names = {"notebook": task.notebook, "assignment": task.assignment, "student": task.student}
                resources = {"nbgrader": {**names, "db_url": url}}
                AssignLatePenalties(config=self._directory.config).preprocess(
                    nodes.notebook([], {}), resources
                )

    def write_feedback(self, assignment: str, submissions: Sequence[Submission]) -> None:
        """Make the HTML pages that go back to the students.

        A page that cannot be made does not keep others from being made: ask :meth:`has_feedback` afterwards.

        Raises:
            OSError: There is no room on the disk.
        """
        with quiet(self._directory.state):
            if feedback.is_usual(self._directory.config):
                for submission in submissions:
                    self._write_pages(submission)
            else:
                self._generate_feedback(assignment, submissions)

    def _write_pages(self, submission: Submission) -> None:
        try:
            self._pages.write(submission, self._directory.notebooks(submission.assignment))
        except Exception as error:
            if is_disk_full(error):
                raise
            logging.getLogger("traitlets").exception("no page for %s", submission.folder)

    def _generate_feedback(self, assignment: str, submissions: Sequence[Submission]) -> None:
        """One conversion for all, since most of its time goes into reading templates."""
        converter = _Feedback(assignment, submissions, self._course())
        with contextlib.suppress(NbGraderException):
            converter.start()
        if converter.cause is not None and is_disk_full(converter.cause):
            raise converter.cause

    def has_feedback(self, submission: Submission, tasks: Sequence[Task]) -> bool:
        """Whether there is a page for each notebook."""
        folder = self._folder("feedback", submission)
        return all((folder / f"{task.notebook}.html").is_file() for task in tasks)

    def _verify(self, submission: Submission, results: Sequence[tuple[Task, Execution]]) -> None:
        found = gradebook.scores_of_student(
            self._directory.gradebook_url, submission.assignment, submission.student
        )
        for task, execution in results:
            for name, score in scores_of(task, execution).items():
                if found.get(task.notebook, {}).get(name) != score:
                    raise NotWritten(f"{task.label}: the gradebook does not have {score:g} points for {name}")

    def _course(self) -> CourseDirectory:
        return CourseDirectory(config=self._directory.config)

    def _folder(self, step: str, submission: Submission) -> Path:
        return self._directory.path / step / submission.student / submission.assignment

    def _record_path(self, submission: Submission) -> Path:
        return self._records / submission.assignment / f"{submission.student}.json"


class _Remembering(BaseConverter):
    """A conversion that remembers what went wrong, which nbgrader only logs."""

    cause: BaseException | None = None

    def convert_single_notebook(self, notebook_filename: str) -> None:
        """Convert one notebook."""
        try:
            super().convert_single_notebook(notebook_filename)
        except Exception as error:
            self.cause = error
            raise


class _Autograde(_Remembering, Autograde):
    """nbgrader's conversion of one submission.

    It expects the notebooks of the assignment, not those that happen to be in the folder: a notebook that was
    not handed in is graded, with zero.
    """

    def __init__(
        self, submission: Submission, results: Sequence[tuple[Task, Execution]], course: CourseDirectory
    ) -> None:
        course.assignment_id, course.student_id = submission.assignment, submission.student
        super().__init__(coursedir=course, config=course.config)
        self.force = True
        self.finished = {task.key(): execution for task, execution in results}
        self._submission = submission
        self._expected = [str(submission.folder / f"{task.notebook}{SUFFIX}") for task, _ in results]

    def convert(self) -> None:
        """Convert the submission.

        Raises:
            Exception: What nbgrader, or a step of it, ran into.
        """
        try:
            self.start()
        except Exception as error:
            raise (self.cause or error) from error

    def init_notebooks(self) -> None:
        """Say what is to be converted."""
        self.assignments = {str(self._submission.folder): self._expected}
        self.notebooks: list[str] = []


class _Feedback(_Remembering, GenerateFeedback):
    """nbgrader's feedback for some submissions of one assignment."""

    def __init__(self, assignment: str, submissions: Sequence[Submission], course: CourseDirectory) -> None:
        course.assignment_id = assignment
        config = Config(course.config)
        config.HTMLExporter.template_name = "feedback"
        super().__init__(coursedir=course, config=config)
        self.force = True
        self._submissions = submissions

    def init_notebooks(self) -> None:
        """Say what is to be converted."""
        self.notebooks: list[str] = []
        self.assignments = {}
        for submission in self._submissions:
            folder = Path(self._format_source(submission.assignment, submission.student))
            self.assignments[str(folder)] = sorted(str(path) for path in folder.glob(f"*{SUFFIX}"))


class _LogFile(logging.FileHandler):
    """A log that gives up in silence: on a full disk its own complaints would drown the one that counts."""

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802  (logging's name)
        """Do nothing."""


@contextlib.contextmanager
def quiet(state: Path) -> Iterator[None]:
    """Nbgrader's words go to a file beside the class, not between the lines of a progress bar."""
    logger = logging.getLogger("traitlets")
    handler = _LogFile(state / "nbgrader.log", delay=True)
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    before, propagates = list(logger.handlers), logger.propagate
    logger.handlers[:] = [handler]
    logger.propagate = False
    try:
        with warnings.catch_warnings():
            # nbgrader 0.9 is written for an older SQLAlchemy, which had not much to say.
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.handlers[:] = before
        logger.propagate = propagates
        handler.close()


def _remove(folder: Path) -> None:
    """Remove a folder of read-only files."""
    if folder.is_dir():
        folder.chmod(0o700)
        shutil.rmtree(folder)
