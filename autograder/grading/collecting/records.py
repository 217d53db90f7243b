"""The record of the collected work, stored in the class. Once work is collected, only the times in it are trusted."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime  # noqa: TC003  (msgspec reads the annotations)
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.collecting.reading.lms_file_names import without_branch
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

FOLDER = "collected"


@dataclass(frozen=True)
class Collected:
    """A notebook that was collected.

    Attributes:
        notebook: The name of the notebook in the class.
        content: The hash of the file's bytes.
        when: The time of handing in, in UTC; None if unknown.
        lms: The system from which it came; empty for plain folders.
        number: The student's number in that system; in Moodle, a different number for each assignment.
        name: The student's name in that system.
        file: The name of the file in that system. Feedback is returned under this name.
        by_hand: True if the instructor put the file into place, and only its time was collected.
    """

    notebook: str
    content: str
    when: datetime | None = None
    lms: str = ""
    number: str = ""
    name: str = ""
    file: str = ""
    by_hand: bool = False


def repository_in(lms: str, parts: Sequence[str], end: str) -> str:
    """Return the GitHub repository in a file's path: the folder or zip whose name ends with the user name."""
    if lms != "github":
        return ""
    *folders, file = parts
    if file.endswith(".zip"):
        folders.append(file.removesuffix(".zip"))
    names = map(without_branch, reversed(folders))
    return next((name for name in names if name.endswith(end)), "")


@dataclass(frozen=True)
class History:
    """The files that were collected from one student for one assignment.

    Attributes:
        now: The files that are in ``submitted`` now, by notebook.
        replaced: The hashes of files that are being replaced, by notebook, while a command is at work.
    """

    now: dict[str, Collected]
    replaced: dict[str, str] = field(default_factory=dict)

    @property
    def when(self) -> datetime | None:
        """The time at which the last of these files was handed in, in UTC; None if unknown."""
        return max((one.when for one in self.now.values() if one.when is not None), default=None)

    def written(self, notebook: str) -> set[str]:
        """Return the hashes of the files that ``collect`` has written to a notebook's place."""
        ours = self.now.get(notebook)
        return {self.replaced.get(notebook, ""), ours.content if ours and not ours.by_hand else ""} - {""}


class CollectedRecords:
    """The records of a class, one file for each submission.

    Args:
        state: The class's folder for the autograder's own files.
    """

    def __init__(self, state: Path) -> None:
        self._folder = state / FOLDER

    @property
    def is_used(self) -> bool:
        """Return True if a file was ever placed in this class."""
        return any(self._folder.glob("*/*.json"))

    def get(self, assignment: str, student: str) -> History | None:
        """Return the record of a submission; None if there is none, or if it is damaged."""
        try:
            return msgspec.json.decode(self._path(assignment, student).read_bytes(), type=History)
        except (OSError, msgspec.MsgspecError):
            return None

    def put(self, assignment: str, student: str, history: History) -> None:
        """Write the record of a submission.

        Raises:
            OSError: The record could not be written.
        """
        write_whole(self._path(assignment, student), msgspec.json.encode(history))

    def all(self) -> list[tuple[str, str]]:
        """Return pairs of a student and an assignment for which there is a record."""
        return [(path.stem, path.parent.name) for path in self._folder.glob("*/*.json")]

    def _path(self, assignment: str, student: str) -> Path:
        return self._folder / assignment / f"{student}.json"
