"""Records of what was entered into the gradebook: from them the next run knows which entries are still right."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory, Submission
from autograder.grading.reporting.rows import Row  # noqa: TC001  (msgspec reads the annotations)
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from autograder.grading.entering.gradebook import Scores


@dataclass(frozen=True)
class Written:
    """The trace of a finished submission in the gradebook.

    Attributes:
        fingerprint: Of all that it was made from.
        keys: The task of each notebook.
        scores: The points of each check cell, by notebook and grade_id.
        rows: The same for the report, with what is wrong.
        course: Stands for the version of the course that it was graded with; empty where nobody wrote it down.
        shown: Stands for what the gradebook said when the pages of feedback were made.
    """

    fingerprint: str
    keys: dict[str, str]
    scores: dict[str, dict[str, float]]
    rows: tuple[Row, ...]
    course: str = ""
    shown: str = ""


class Records:
    """One file a submission.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory
        self._folder = directory.state / "written"

    def get(self, submission: Submission) -> Written | None:
        """The record of what was written; None where nothing was, or where the file is damaged."""
        try:
            return msgspec.json.decode(self._path(submission).read_bytes(), type=Written)
        except (OSError, msgspec.MsgspecError):
            return None

    def put(self, submission: Submission, written: Written) -> None:
        """Write down what was written.

        Raises:
            OSError: It could not be written.
        """
        write_whole(self._path(submission), msgspec.json.encode(written))

    def forget(self, submission: Submission) -> None:
        """From now on nothing is known of this submission."""
        self._path(submission).unlink(missing_ok=True)

    def holds(self, submission: Submission, written: Written, in_gradebook: Mapping[str, Scores]) -> bool:
        """True if gradebook and folders still have what was written.

        Args:
            submission: The submission.
            written: What was written.
            in_gradebook: The scores that the gradebook has for it now, by notebook.
        """
        folder = self._directory.path / "autograded" / submission.student / submission.assignment
        return all((folder / f"{notebook}{SUFFIX}").is_file() for notebook in written.keys) and all(
            in_gradebook.get(notebook, {}).get(name) == score
            for notebook, scores in written.scores.items()
            for name, score in scores.items()
        )

    def has_pages(self, submission: Submission, notebooks: Sequence[str]) -> bool:
        """True if there is a feedback page for each notebook."""
        folder = self._directory.path / "feedback" / submission.student / submission.assignment
        return all((folder / f"{notebook}.html").is_file() for notebook in notebooks)

    def _path(self, submission: Submission) -> Path:
        return self._folder / submission.assignment / f"{submission.student}.json"
