"""The record of what was collected, beside the class: from then on only its times are believed."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from datetime import datetime  # noqa: TC003  (msgspec reads the annotations)
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.collecting.forms import without_branch
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

FOLDER = "collected"


@dataclass(frozen=True)
class Collected:
    """One notebook that was collected.

    Attributes:
        notebook: Its name in the class.
        content: The hash of its bytes.
        source: The name of the file it came from, for messages.
        collected: The time of collecting, in UTC.
        when: The time of handing in, in UTC; None where nothing says it.
        order: Grows with later files where there are no times.
        late: Whether the LMS marks it as late.
        lms: The system that it came from, empty for plain folders.
        number: The student's number there: for Canvas of the student, for Moodle of the student in this assignment.
        name: The student's name there.
        file: The name of the file there, which its feedback goes back under.
        by_hand: Whether the instructor put it there, and only its time was collected.
    """

    notebook: str
    content: str
    source: str
    collected: datetime
    when: datetime | None = None
    order: int = 0
    late: bool = False
    lms: str = ""
    number: str = ""
    name: str = ""
    file: str = ""
    by_hand: bool = False


def repository_of(one: Collected) -> str:
    """The name of the repository of GitHub's that a notebook came from; empty for another system's.

    It ends with a user name, and so does the repository of whoever takes a name that ends as that one.
    """
    if one.lms != "github":
        return ""
    *folders, file = one.file.split("/")
    if file.endswith(".zip"):
        folders.append(file.removesuffix(".zip"))
    names = map(without_branch, reversed(folders))
    return next((name for name in names if name.endswith(one.number or one.name)), "")


@dataclass(frozen=True)
class History:
    """The files that were collected of one student for one assignment.

    Attributes:
        now: The content of ``submitted``, by notebook.
        before: The notebooks that it has replaced, the oldest first; their bytes are kept.
    """

    now: dict[str, Collected]
    before: tuple[Collected, ...] = ()

    @property
    def when(self) -> datetime | None:
        """The time at which the last of it was handed in, in UTC; None where nothing says so."""
        return max((one.when for one in self.now.values() if one.when is not None), default=None)

    def collected(self, notebook: str) -> set[str]:
        """The hashes of all that was ever put at a notebook's place, and may be replaced."""
        ours = (one for one in (*self.now.values(), *self.before) if one.notebook == notebook)
        return {one.content for one in ours if not one.by_hand}


class CollectedRecords:
    """One file a submission, and the notebooks that were replaced.

    Args:
        state: The class's folder of the autograder's own files.
    """

    def __init__(self, state: Path) -> None:
        self._folder = state / FOLDER

    @property
    def is_used(self) -> bool:
        """True if anything was ever put at its place in this class, not only named as having none."""
        return any(self._folder.glob("*/*.json"))

    def get(self, assignment: str, student: str) -> History | None:
        """The record of what was collected; None where nothing was, or where the file is damaged."""
        try:
            return msgspec.json.decode(self._path(assignment, student).read_bytes(), type=History)
        except (OSError, msgspec.MsgspecError):
            return None

    def put(self, assignment: str, student: str, history: History) -> None:
        """Write down what was collected.

        Raises:
            OSError: It could not be written.
        """
        write_whole(self._path(assignment, student), msgspec.json.encode(history))

    def keep(self, assignment: str, student: str, content: str, data: bytes) -> None:
        """Keep the bytes of a notebook that is replaced, packed: what is kept must not be larger than what was sent.

        Raises:
            OSError: They could not be written.
        """
        # No student's record is called so, whatever the student is called.
        file = self._folder / assignment / f"{student}.kept" / f"{content[:16]}.ipynb.gz"
        write_whole(file, gzip.compress(data, mtime=0))

    def _path(self, assignment: str, student: str) -> Path:
        return self._folder / assignment / f"{student}.json"
