"""Runs ``nbgrader autograde`` and ``nbgrader generate_feedback``, or formgrader's buttons, with the course's grader.

nbgrader's own conversion has no judge, and copies whatever is in a submission: a pipe would block it for ever, and a
sparse file of a terabyte would fill the disk. So its steps are replaced by those of ``./course grade``. The class's
configuration names the exporters below. nbgrader makes an exporter before it converts the first notebook, and these
exporters then take over the converter that made them.
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
    """A conversion of whole submissions by this package's grader.

    nbgrader has listed in ``assignments`` the folders to convert.
    """

    def convert_notebooks(self) -> None:
        """Convert the submissions that were asked for.

        Raises:
            NbGraderException: Some could not be converted; the log has a line for each.
            SystemExit: The same, if nbgrader runs as a command: with the exit code of ``./course grade``, which
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
        """Return the students that were asked for, by assignment.

        Raises:
            GradingError: A single notebook was asked for.
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
        """Convert submissions. Return what went wrong."""
        raise NotImplementedError


class _OurAutograde(_Ours, Autograde):
    """``nbgrader autograde``: what ``./course grade`` does, without pages of feedback."""

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
            # A file without a place may belong to any student: it is not a failure of the submission being graded.
            refused = [(f"{one.path}: {one.reason}", one.path.is_absolute()) for one in report.refused]
            remarks = [f"{'/'.join(key)}: {words}" for key, words in remarks_on(report.rows).items()]
            for notice in (*report.notices, *remarks, *(text for text, in_class in refused if not in_class)):
                self.log.warning("%s", notice)
            problems += [text for text, in_class in refused if in_class or everybody]
            problems += report.problems
        return problems


class _OurFeedback(_Ours, GenerateFeedback):
    """``nbgrader generate_feedback``: the pages that ``./course grade`` makes, for what is graded already."""

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
    """Let the grader do the work of nbgrader's converter.

    Args:
        converter: A converter that has not begun; any other object is left unchanged.
    """
    ours = {Autograde: _OurAutograde, GenerateFeedback: _OurFeedback}.get(type(converter))
    if ours is not None:
        # nbgrader offers no way to choose the class of the converter.
        converter.__class__ = ours


class SubmissionExporter(NotebookExporter):
    """nbgrader finds this package's way of grading by this name, however ``autograde`` is started."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        _take_over(self.parent)


class FeedbackExporter(PageExporter):
    """nbgrader finds this package's way of making pages by this name, however ``generate_feedback`` is started."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        _take_over(self.parent)


class WireExecute(NbGraderPreprocessor):
    """Replaces nbgrader's Execute and refuses to grade.

    The section of its name in the configuration contains the grader's settings: limits, and two switches.
    """

    def preprocess(self, *_: Any, **__: Any) -> tuple[Any, Any]:
        """Report the missing line: nbgrader calls this only if the line that leads to the grader was removed.

        Raises:
            TypeError: Always.
        """
        raise TypeError(f"Autograde.exporter_class must be {__name__}.SubmissionExporter")
