"""The records of collected work, stored in the class. If a class has records, only the times in them are trusted."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.collecting.line import Line  # noqa: TC001  (msgspec reads the annotations)
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

FOLDER = "collected"


@dataclass(frozen=True)
class History:
    """The files that were collected from one student for one assignment.

    Attributes:
        now: The files that are in ``submitted`` now, by notebook.
        replaced: While a command is replacing files: the hashes of the old files, by notebook.
    """

    now: dict[str, Line]
    replaced: dict[str, str] = field(default_factory=dict)

    @property
    def when(self) -> datetime | None:
        """The time at which the last of these files was handed in, in UTC; None if unknown."""
        return max((one.when for one in self.now.values() if one.when is not None), default=None)

    def written(self, notebook: str) -> set[str]:
        """Return the hashes of the files that ``collect`` has written into ``submitted`` as this notebook."""
        ours = self.now.get(notebook)
        return {self.replaced.get(notebook, ""), ours.content if ours and not ours.is_by_hand else ""} - {""}


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
