"""Makes ``nbgrader autograde``, ``nbgrader generate_feedback`` and formgrader's buttons use the course's grader.

nbgrader's own conversion does not use the judge, and it copies whatever is in a submission: a pipe would block it
forever, and a sparse file of a terabyte would fill the disk. So its steps are replaced by those of ``./course
grade``. The class's configuration names the exporters below. nbgrader makes its exporter before it converts the first
notebook, and at that moment the exporters below take over the converter that made them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nbconvert.exporters import NotebookExporter
from nbgrader.converters import Autograde, BaseConverter, GenerateFeedback, NbGraderException
from nbgrader.preprocessors import NbGraderPreprocessor
from rich.console import Console
from traitlets.config import Application

from autograder.cards.readable import printable
from autograder.grading.batch import grade
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory, Submission, reason_against_name
from autograder.grading.classes.configuration import check_configuration
from autograder.grading.errors import GradingError, check_known
from autograder.grading.gradebooks.writer import Writer
from autograder.grading.reporting.rows import remarks_on
from autograder.grading.returning.page_exporter import PageExporter

if TYPE_CHECKING:
    from collections.abc import Iterator


CANNOT = 2
"""The exit code of ``./course grade`` if something could not be checked or had to be refused."""


class _Ours(BaseConverter):
    """A conversion of whole submissions by this package's grader, instead of nbgrader's converter.

    nbgrader has already listed the folders to convert in ``assignments``.
    """

    def convert_notebooks(self) -> None:
        """Convert the submissions that were chosen.

        Raises:
            NbGraderException: Some submissions could not be converted. The log has a line for each.
            SystemExit: Raised instead if nbgrader runs as a command, with the exit code of ``./course grade``, which
                nbgrader would turn into 1.
        """
        try:
            problems = self._convert(ClassDirectory(Path(self.coursedir.root)), self._chosen())
        except GradingError as error:
            problems = [str(error)]
        problems = list(map(printable, problems))
        for problem in problems:
            self.log.error("%s", problem)
        if problems and isinstance(self.parent, Application):
            raise SystemExit(CANNOT)
        if problems:
            raise NbGraderException("; ".join(problems))

    def _chosen(self) -> dict[str, list[str]]:
        """Return the chosen students, by assignment.

        Raises:
            GradingError: A single notebook was chosen.
        """
        if self.coursedir.notebook_id != "*":
            raise GradingError(
                "A submission is graded as a whole, with all of its notebooks: leave out --notebook."
            )
        chosen: dict[str, list[str]] = {}
        for folder in sorted(map(Path, self.assignments)):
            chosen.setdefault(folder.name, []).append(folder.parent.name)
        return chosen

    def _convert(self, directory: ClassDirectory, chosen: dict[str, list[str]]) -> list[str]:
        """Convert submissions, and return a message for each failure."""
        raise NotImplementedError


class _OurAutograde(_Ours, Autograde):
    """``nbgrader autograde``, replaced by the steps of ``./course grade`` without feedback pages."""

    def _convert(self, directory: ClassDirectory, chosen: dict[str, list[str]]) -> list[str]:
        problems: list[str] = []
        for assignment, students in chosen.items():
            everybody = self.coursedir.student_id == "*"
            report = grade(
                directory.path,
                assignments=[assignment],
                students=() if everybody else students,
                feedback=False,
                console=Console(quiet=True),
            )
            # A file that could not be placed may belong to any student, so it is not a failure of the submission
            # being graded.
            refused = [(f"{one.path}: {one.reason}", one.path.is_absolute()) for one in report.refused]
            remarks = [f"{'/'.join(key)}: {words}" for key, words in remarks_on(report.rows).items()]
            for notice in (*report.notices, *remarks, *(text for text, in_class in refused if not in_class)):
                self.log.warning("%s", notice)
            problems += [text for text, in_class in refused if in_class or everybody]
            problems += report.problems
        return problems


class _OurFeedback(_Ours, GenerateFeedback):
    """``nbgrader generate_feedback``, replaced: makes the pages of ``./course grade`` for work that is graded."""

    def _convert(self, directory: ClassDirectory, chosen: dict[str, list[str]]) -> list[str]:
        check_configuration(directory)
        problems = []
        with directory.lock(), ClassStore(directory) as store:
            writer = Writer(directory, store)
            for submission in self._submissions(directory, chosen):
                name = f"{submission.student}/{submission.assignment}"
                if reason := reason_against_name(submission.student):
                    problems.append(f"{name}: {reason}; rename the folder")
                    continue
                if not writer.write_feedback(submission):
                    problems.append(
                        f"{name}: its page could not be made (see {directory.state / 'nbgrader.log'})"
                    )
        return problems

    @staticmethod
    def _submissions(directory: ClassDirectory, chosen: dict[str, list[str]]) -> Iterator[Submission]:
        check_known(list(chosen), directory.assignments(), "assignment")
        for assignment, students in chosen.items():
            for student in students:
                folder = directory.path / "submitted" / student / assignment
                yield Submission(student, assignment, folder)


def _take_over(converter: object) -> None:
    """Let this package's grader do the work of nbgrader's converter.

    Args:
        converter: A converter that has not begun to convert. Any other object is left unchanged.
    """
    ours = {Autograde: _OurAutograde, GenerateFeedback: _OurFeedback}.get(type(converter))
    if ours is not None:
        # nbgrader offers no option for the class of its converter.
        converter.__class__ = ours


class SubmissionExporter(NotebookExporter):
    """The exporter that class configurations name for ``autograde``. Making it lets this package's grader take over."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        _take_over(self.parent)


class FeedbackExporter(PageExporter):
    """The exporter that class configurations name for ``generate_feedback``. Making it lets this package take over."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        _take_over(self.parent)


class WireExecute(NbGraderPreprocessor):
    """Replaces nbgrader's Execute preprocessor, and refuses to grade.

    The configuration section with this class's name contains the grader's settings: limits, and two switches.
    """

    def preprocess(self, *_: Any, **__: Any) -> tuple[Any, Any]:
        """Report that the exporter's line is missing in the configuration, the only case in which nbgrader calls this.

        Raises:
            TypeError: Always.
        """
        raise TypeError(f"Autograde.exporter_class must be {__name__}.SubmissionExporter")
