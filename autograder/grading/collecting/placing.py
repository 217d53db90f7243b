"""Which of a student's files counts, and putting it into ``submitted`` so that nothing is lost."""

from __future__ import annotations

import functools
import hashlib
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory
from autograder.grading.classes.timestamps import TIMESTAMP, timestamp_text
from autograder.grading.collecting.archives import NotPlaced
from autograder.grading.collecting.records import Collected, CollectedRecords, History
from autograder.grading.entering.journal import write_whole
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.grading.collecting.archives import File
    from autograder.grading.collecting.forms import Found


@dataclass(frozen=True)
class Placed:
    """A notebook that was put into ``submitted``.

    Attributes:
        student: Whose it is.
        assignment: Which it is for.
        label: Where it came from.
        when: When it was handed in, in UTC; None where nothing says so.
        late: Whether the LMS marks it as late.
        replaced: Whether an earlier one lay there, which is kept.
    """

    student: str
    assignment: str
    label: str
    when: datetime | None
    late: bool
    replaced: bool


@dataclass(frozen=True)
class Candidate:
    """A file of which it is known whose it is and which notebook.

    Attributes:
        file: Where it was found.
        found: What its name says.
        student: Whose it is.
        assignment: Which it is for.
        notebook: Which notebook of that.
        data: Its bytes.
        when: When it was handed in, in UTC; None where nothing says so.
        order: Grows with later files: the number that the LMS gave it, then the one in its name.
        is_told: Whether its name or its cells say that it is this notebook, and not the instructor alone.
    """

    file: File
    found: Found
    student: str
    assignment: str
    notebook: str
    data: bytes
    when: datetime | None
    order: tuple[int, int]
    is_told: bool

    @functools.cached_property
    def content(self) -> str:
        """The hash of its bytes."""
        return hashlib.sha256(self.data).hexdigest()


class Placing:
    """Puts notebooks into a class and keeps the lists of what became of each.

    Args:
        directory: The class, locked by this process.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory
        self._records = CollectedRecords(directory.state)
        self.placed: list[Placed] = []
        self.older: list[NotPlaced] = []
        self.not_placed: list[NotPlaced] = []
        self.unchanged = 0

    def newest(self, group: list[Candidate]) -> Candidate | None:
        """Which of a student's files counts; the others are listed. None where nothing says which."""
        timed = all(candidate.when is not None for candidate in group)

        def age(candidate: Candidate) -> tuple[float, tuple[int, int]]:
            return (candidate.when.timestamp() if timed and candidate.when else 0.0, candidate.order)

        newest = max(group, key=age)
        for other in group:
            if other is newest:
                continue
            if other.content == newest.content:
                self.unchanged += 1
            elif age(other) == age(newest):
                for one in group:
                    self.refuse(
                        one.file.label,
                        f"{newest.student} has several different files for {newest.assignment}, and nothing says which "
                        "is the newest: collect the one that counts",
                    )
                return None
            else:
                self.older.append(NotPlaced(other.file.label, f"{newest.file.label} is newer"))
        return newest

    def put(self, newest: Candidate) -> None:
        """Put a notebook into ``submitted`` and write down where it came from.

        Raises:
            OSError: It could not be written.
        """
        folder = self._directory.path / "submitted" / newest.student / newest.assignment
        path = folder / f"{newest.notebook}{SUFFIX}"
        history = self._records.get(newest.assignment, newest.student) or History({})
        known = history.now.get(newest.notebook)
        reason, there = self._reason_against_putting(newest, folder, path, history)
        if reason:
            (self.refuse if known is None else self._keep_older)(newest.file.label, reason)
            return
        if there == newest.data and known is not None and known.when == newest.when:
            self.unchanged += 1
            return
        if there is not None and there != newest.data:
            content = hashlib.sha256(there).hexdigest()
            self._records.keep(newest.assignment, newest.student, content, there)
        if there != newest.data:
            write_whole(path, newest.data)
        identity = newest.found.identity
        now = Collected(
            newest.notebook,
            newest.content,
            newest.file.label,
            datetime.now(tz=UTC),
            newest.when,
            newest.found.order,
            newest.found.late,
            identity.lms,
            identity.number,
            identity.name or identity.login,
            newest.file.parts[-1] if len(newest.file.parts) == 1 else "/".join(newest.file.parts),
        )
        before = (*history.before, known) if known is not None and there != newest.data else history.before
        history = replace(history, now={**history.now, newest.notebook: now}, before=before)
        self._records.put(newest.assignment, newest.student, history)
        _write_time(folder, history.when)
        self.placed.append(
            Placed(
                newest.student,
                newest.assignment,
                newest.file.label,
                newest.when,
                newest.found.late,
                replaced=there is not None and there != newest.data,
            )
        )

    def _reason_against_putting(
        self, newest: Candidate, folder: Path, path: Path, history: History
    ) -> tuple[str, bytes | None]:
        """Why what lies there stays, empty where it does not; and what lies there."""
        for place in (folder.parent, folder, path):
            if place.is_symlink():
                return f"{place} is a link: remove it", None
        if not path.exists():
            return "", None
        try:
            there = read_bytes(path)
        except UnreadableSubmission as error:
            return f"something else lies at {path}: {error}", None
        known = history.now.get(newest.notebook)
        if there == newest.data:
            return "", there
        if known is None or known.content != hashlib.sha256(there).hexdigest():
            return f"{path} is another notebook, which nobody collected: move it away first", there
        if any(one.content == newest.content for one in history.before):
            return "it was collected before, and a newer one after it", there
        if newest.when is not None and known.when is not None and newest.when < known.when:
            return f"the one collected before was handed in later ({known.when:%Y-%m-%d %H:%M} UTC)", there
        if newest.found.order and newest.found.order < known.order:
            return "the one collected before was handed in later", there
        return "", there

    def refuse(self, label: str, reason: str) -> None:
        """Note what could not be placed."""
        self.not_placed.append(NotPlaced(label, reason))

    def _keep_older(self, label: str, reason: str) -> None:
        self.older.append(NotPlaced(label, reason))


def _write_time(folder: Path, when: datetime | None) -> None:
    """Write down when work was handed in, as nbgrader reads it; whoever wrote that file before."""
    if when is None:
        (folder / TIMESTAMP).unlink(missing_ok=True)
    else:
        write_whole(folder / TIMESTAMP, f"{timestamp_text(when)}\n".encode())
