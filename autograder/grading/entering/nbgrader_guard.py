"""What nbgrader's own conversions must not do to a class, whether a command or formgrader's button starts them.

They run while ``autograder grade`` does, and they copy whatever lies in a submission: a pipe would hold them up for
ever, and a file with a hole of a terabyte would fill the disk. nbgrader asks our exporters to read and to render
(``nbgrader_config.py`` names them), and through these the conversion that made them is replaced by its guarded form.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nbgrader.converters import Autograde, BaseConverter, GenerateFeedback, NbGraderException

from autograder.grading.classes.class_directory import ClassDirectory, reason_against_name
from autograder.grading.classes.timestamps import companions, handed_in_at
from autograder.grading.errors import GradingError


class _AloneInTheClass(BaseConverter):
    """A conversion that keeps other batches out while it runs, and folders whose names no student can have."""

    def convert_notebooks(self) -> None:
        """Convert everything that can be.

        Raises:
            NbGraderException: Somebody else is at work, or something was left out; the log has the same words.
        """
        refused = self._refuse_names()
        try:
            with ClassDirectory(Path(self.coursedir.root)).lock():
                super().convert_notebooks()
        except GradingError as error:
            self.log.error("%s", error)
            raise NbGraderException(str(error)) from error
        if refused:
            raise NbGraderException("; ".join(refused))

    def _refuse_names(self) -> list[str]:
        """Leave out the folders with names that nbgrader stumbles over, or that it would write into its pages."""
        refused = []
        for folder in list(self.assignments):
            reason = reason_against_name(Path(folder).parent.name)
            if reason:
                refused.append(f"{folder!a}: {reason}; rename the folder")
                self.log.error("%s", refused[-1])
                del self.assignments[folder]
        return refused


class _CopiesNothing(BaseConverter):
    """A conversion that believes no name and takes nothing along but nbgrader's time and secret of the submission."""

    def init_destination(self, assignment_id: str, student_id: str) -> bool:
        """Whether there is something to do, found out without trusting what lies in the submission."""
        course: Any = self.coursedir
        course.get_existing_timestamp = lambda folder: handed_in_at(Path(folder))
        return super().init_destination(assignment_id, student_id)

    def init_assignment(self, assignment_id: str, student_id: str) -> None:
        """In the place of nbgrader's copying."""
        folder = Path(self._format_dest(assignment_id, student_id))
        for name, data in companions(Path(self._format_source(assignment_id, student_id))).items():
            folder.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)


class GuardedAutograde(Autograde, _CopiesNothing):
    """``nbgrader autograde`` for a caller that holds the class's lock."""


class _PlainAutograde(_AloneInTheClass, GuardedAutograde):
    """``nbgrader autograde`` itself."""


class _PlainFeedback(_AloneInTheClass, GenerateFeedback):
    """``nbgrader generate_feedback`` itself."""


def guard(converter: object) -> None:
    """Give a conversion of nbgrader its guarded form; one of our own has it already.

    Args:
        converter: It has not yet begun to convert.
    """
    guarded = {Autograde: _PlainAutograde, GenerateFeedback: _PlainFeedback}.get(type(converter))
    if guarded is not None:
        # nbgrader offers no way to say which class it shall make.
        converter.__class__ = guarded
