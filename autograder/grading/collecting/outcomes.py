"""The outcome of each file that was collected: to its place, among earlier attempts, or nowhere, with the reason."""

from __future__ import annotations

import functools
import hashlib
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.collecting.records import FOLDER
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from datetime import datetime
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory


class State(StrEnum):
    """The outcome of a file; each file has one of these."""

    PLACED = "placed"
    """It is in ``submitted``."""
    UNCHANGED = "unchanged"
    """The same is there already."""
    EARLIER = "earlier"
    """Another one counts; this one is kept."""
    BESIDE = "beside"
    """It is no notebook that was asked for, and its student has handed in one, or it is the LMS's own page."""
    NOT_PLACED = "not placed"
    """Somebody has to look: it may be somebody's work."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one file.

    Attributes:
        label: The file's name in messages.
        state: The place where it went.
        reason: The reason why it is not at its place, and what to type; empty where it is there.
        student: The student's id; empty where it is not known.
        assignment: The assignment's name; empty where it is not known.
        when: The time of handing in, in UTC; None where nothing says it.
        late: Whether the LMS marks it as late.
        replaced: Whether another one lay at its place, which is kept.
        what_to_do: The advice if its student's notebook has not come; empty where the reason says it.
        content: The hash of its bytes; empty where nobody could read them.
    """

    label: str
    state: State
    reason: str = ""
    student: str = ""
    assignment: str = ""
    when: datetime | None = None
    late: bool = False
    replaced: bool = False
    what_to_do: str = ""
    content: str = ""


@dataclass(frozen=True)
class CollectReport:
    """The result of collecting.

    Attributes:
        path: The class.
        outcomes: The outcome of each file.
        unread_times: Times in names and lists that nobody could read.
        untimed: Students for whose work, collected now, nothing says the time of handing in; by assignment.
        missing: Students who have handed in nothing, by assignment.
        by_their_names: Whether there is no list of students, so that folders have the LMS's names.
        notes: Times that were noted, names in a list that are no student's, empty downloads.
    """

    path: Path
    outcomes: tuple[Outcome, ...] = ()
    unread_times: tuple[str, ...] = ()
    untimed: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: dict[str, tuple[str, ...]] = field(default_factory=dict)
    by_their_names: bool = False
    notes: tuple[str, ...] = ()

    def having(self, state: State) -> tuple[Outcome, ...]:
        """The files that went there."""
        return tuple(one for one in self.outcomes if one.state == state)

    @property
    def exit_code(self) -> int:
        """0 when everything has its place; 2 when somebody has to look."""
        return 2 if self.having(State.NOT_PLACED) else 0


@dataclass(frozen=True)
class Waiting:
    """A file without a place, written down until its student's work is at its place.

    Attributes:
        label: The file's name in messages.
        reason: The reason why it has no place, and what to type.
        student: The student's id; empty where it is not known.
        assignment: The assignment's name; empty where it is not known.
        there: A digest of what lay at its place then: when something else does, it is settled.
        content: The hash of its bytes; empty where nobody could read them.
    """

    label: str
    reason: str
    student: str
    assignment: str
    there: str
    content: str = ""


class WaitingList:
    """The files that have no place, for the commands that grade, report and export after collecting.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory
        self._path = directory.state / FOLDER / "not_placed.json"

    def read(self) -> list[Waiting]:
        """The files at whose place nothing else has come since."""
        try:
            known = msgspec.json.decode(self._path.read_bytes(), type=list[Waiting])
        except (OSError, msgspec.MsgspecError):
            return []
        there = functools.cache(self._there)  # one archive may have thousands of files without a place
        return [one for one in known if not one.assignment or one.there == there(one.student, one.assignment)]

    def note(self, outcomes: Sequence[Outcome]) -> None:
        """Write down the files that have no place now, in place of what was written of the same ones before.

        Raises:
            OSError: It could not be written.
        """
        again = {key for one in outcomes for key in _keys(one)}
        kept = [one for one in self.read() if not again.intersection(_keys(one))]
        there = functools.cache(self._there)
        new = [
            Waiting(
                one.label,
                one.reason,
                one.student,
                one.assignment,
                there(one.student, one.assignment),
                one.content,
            )
            for one in outcomes
            if one.state == State.NOT_PLACED
        ]
        self._write([*kept, *new])

    def settle(self, labels: Iterable[str]) -> list[str]:
        """Forget files that need no place, and give back the names that are not in the list.

        Raises:
            OSError: It could not be written.
        """
        labels, known = set(labels), self.read()
        self._write([one for one in known if one.label not in labels])
        return sorted(labels - {one.label for one in known})

    def _there(self, student: str, assignment: str) -> str:
        """A digest of the notebooks at a file's place; empty where its place is not known."""
        if not student or not assignment:
            return ""
        folder = self._directory.path / "submitted" / student / assignment
        digest = hashlib.sha256()
        for path in sorted(folder.glob(f"*{SUFFIX}")):
            try:
                digest.update(path.name.encode() + b"\0" + hashlib.sha256(read_bytes(path)).digest())
            except UnreadableSubmission as error:
                digest.update(str(error).encode())
        return digest.hexdigest()

    def _write(self, waiting: list[Waiting]) -> None:
        if waiting or self._path.exists():
            write_whole(self._path, msgspec.json.encode(waiting))


def _keys(one: Outcome | Waiting) -> Iterator[tuple[str, ...]]:
    """What makes two files the same file, or the one come in the place of the other: they share one of these.

    Downloads of every week have files of one name: what is only called alike may be another assignment's work.
    """
    if one.content:
        yield "of one name", one.label, one.content
    if one.content and one.student:
        yield "of one student", one.student, one.content
    if one.assignment or not one.content:
        yield "again", one.label, one.student, one.assignment
