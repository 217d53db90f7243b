"""Makes ``nbgrader autograde``, ``nbgrader generate_feedback`` and formgrader's buttons use the course's grader.

nbgrader's own conversion does not use the judge. It also copies every file of a submission: a pipe would block it
forever, and a sparse file of a terabyte would fill the disk. So the steps of ``./course grade`` replace it. For this,
the class's configuration names the exporters of this module. nbgrader makes an exporter before it converts the first
notebook, and the exporter's constructor replaces the class of nbgrader's converter by a class of this module.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nbconvert.exporters import NotebookExporter
from nbgrader.converters import Autograde, BaseConverter, GenerateFeedback, NbGraderException
from nbgrader.preprocessors import NbGraderPreprocessor
from rich.console import Console
from traitlets.config import Application

from autograder.grading.batch import grade
from autograder.grading.class_checks import check_configuration
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory, Submission
from autograder.grading.classes.student_folders import reason_against_name
from autograder.grading.grading_errors import GradingError, check_known
from autograder.grading.result_writer import Writer
from autograder.grading.returning.page_exporter import PageExporter
from autograder.grading.table.rows import remarks_on
from autograder.standard_output import printable

if TYPE_CHECKING:
    from collections.abc import Iterator


CANNOT = 2
"""The exit code of ``./course grade`` if a check could not be made or a file was refused."""


class _Ours(BaseConverter):
    """A converter of nbgrader for which this package's grader converts whole submissions.

    Which folders are to be converted is found by nbgrader itself, which puts them into ``assignments``.
    """

    def convert_notebooks(self) -> None:
        """Convert the chosen submissions.

        Raises:
            NbGraderException: Some submissions could not be converted; the log has a line for each.
            SystemExit: The same, if nbgrader runs as a command. The exit code is that of ``./course grade``; after an
                NbGraderException, it would be 1.
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
                "Only whole submissions can be graded, with all of their notebooks: leave out --notebook."
            )
        chosen: dict[str, list[str]] = {}
        for folder in sorted(map(Path, self.assignments)):
            chosen.setdefault(folder.name, []).append(folder.parent.name)
        return chosen

    def _convert(self, directory: ClassDirectory, chosen: dict[str, list[str]]) -> list[str]:
        """Convert submissions, and return a message for each failure."""
        raise NotImplementedError


class _OurAutograde(_Ours, Autograde):
    """Replaces ``nbgrader autograde`` by the steps of ``./course grade``, without making feedback pages."""

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
            # This is only a warning, not a failure, because a collected file without a known student may belong to any
            # student.
            refused = [(f"{one.path}: {one.reason}", one.path.is_absolute()) for one in report.refused]
            remarks = [f"{'/'.join(key)}: {words}" for key, words in remarks_on(report.rows).items()]
            for notice in (*report.notices, *remarks, *(text for text, in_class in refused if not in_class)):
                self.log.warning("%s", notice)
            problems += [text for text, in_class in refused if in_class or everybody]
            problems += report.problems
        return problems


class _OurFeedback(_Ours, GenerateFeedback):
    """Replaces ``nbgrader generate_feedback``: makes the feedback pages of ``./course grade``."""

    def _convert(self, directory: ClassDirectory, chosen: dict[str, list[str]]) -> list[str]:
        check_configuration(directory)
        problems = []
        with directory.lock(), ClassStore(directory) as store:
            writer = Writer(directory, store)
            for submission in self._submissions(directory, chosen):
                name = submission.label
                if reason := reason_against_name(submission.student):
                    problems.append(f"{name}: {reason}; rename the folder")
                    continue
                if not writer.write_feedback(submission):
                    problems.append(
                        f"{name}: the feedback page could not be made (see {directory.state / 'nbgrader.log'})"
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
    """Replace the class of nbgrader's converter by the one of this module.

    Args:
        converter: A converter that has not begun to convert. An object that is not a converter is left unchanged.
    """
    ours = {Autograde: _OurAutograde, GenerateFeedback: _OurFeedback}.get(type(converter))
    if ours is not None:
        # The object's class is replaced because nbgrader has no option for the class of its converter.
        converter.__class__ = ours


class SubmissionExporter(NotebookExporter):
    """The exporter for ``autograde`` in a class's configuration. Making it replaces nbgrader's converter."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        super().__init__(*args, **kw)
        _take_over(self.parent)


class FeedbackExporter(PageExporter):
    """The exporter for ``generate_feedback`` in a class's configuration. Making it replaces nbgrader's converter."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        super().__init__(*args, **kw)
        _take_over(self.parent)


class WireExecute(NbGraderPreprocessor):
    """Takes the place of nbgrader's Execute preprocessor, but only raises an error.

    The section ``c.WireExecute`` of a class's configuration contains the grader's settings: limits, and two switches.
    """

    def preprocess(self, *_: Any, **__: Any) -> tuple[Any, Any]:
        """Raise an error: nbgrader calls this only if a class's configuration lacks the line for the exporter.

        Raises:
            TypeError: Always.
        """
        raise TypeError(f"Autograde.exporter_class must be {__name__}.SubmissionExporter")
