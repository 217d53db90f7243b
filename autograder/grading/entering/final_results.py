"""Results that are final, each under the hash of all it depends on; what is here is not executed again."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.execution import Execution  # noqa: TC001  (msgspec reads the annotations)
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from autograder.grading.classes.class_directory import Submission
    from autograder.grading.task import Task


@dataclass(frozen=True)
class _Entry:
    key: str
    execution: Execution


class Journal:
    """One file a student's notebook, replaced as a whole: a killed run leaves old or new, nothing between.

    Args:
        folder: Made when the first result is written.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def get(self, task: Task) -> Execution | None:
        """The execution of exactly this task, or None. A damaged entry counts as none."""
        try:
            entry = msgspec.json.decode(self._path(task).read_bytes(), type=_Entry)
        except (OSError, msgspec.MsgspecError):
            return None
        return entry.execution if entry.key == task.key() else None

    def latest(self, student: str, assignment: str) -> list[Execution]:
        """The last execution of each notebook of a submission, also where another file is there now."""
        found = []
        for path in sorted((self._folder / assignment).glob("*.json")):
            if path.stem.partition("@")[2] == student:
                with contextlib.suppress(OSError, msgspec.MsgspecError):
                    found.append(msgspec.json.decode(path.read_bytes(), type=_Entry).execution)
        return found

    def put(self, task: Task, execution: Execution) -> None:
        """Keep a result, unless the grader itself had trouble: that is tried again at the next run.

        Raises:
            OSError: It could not be written.
        """
        if not execution.trouble:
            write_whole(self._path(task), msgspec.json.encode(_Entry(task.key(), execution)))

    def has(self, submission: Submission, notebooks: Iterable[str]) -> bool:
        """True if anything is known of a submission; it may be of an earlier version of it."""
        return any(self._file(submission, notebook).is_file() for notebook in notebooks)

    def forget(self, submission: Submission, notebooks: Iterable[str]) -> None:
        """Drop what is known of a submission."""
        for notebook in notebooks:
            self._file(submission, notebook).unlink(missing_ok=True)

    def _path(self, task: Task) -> Path:
        return self._folder / task.assignment / f"{task.notebook}@{task.student}.json"

    def _file(self, submission: Submission, notebook: str) -> Path:
        return self._folder / submission.assignment / f"{notebook}@{submission.student}.json"
