"""The files that ``collect`` was given: their bytes, the decision about each, and which of them are in ``submitted``.

The inbox of a class has every file, stored by the hash of its bytes, with its origin. Each ``collect`` command makes
one delivery, which is one file on the disk: a zip with the new bytes and a list of the files that came. The zip is
written completely or not at all, and never changes. If the same command is run again with the same files, it makes the
same zip.

A record of each submission has the lines of the files that are in ``submitted``. If a class has records, only the times
in them are trusted.
"""

from __future__ import annotations

import contextlib
import hashlib
import secrets
import zipfile
from dataclasses import dataclass, field, replace
from datetime import datetime  # noqa: TC003  (msgspec reads the annotations)
from enum import StrEnum
from typing import TYPE_CHECKING

import msgspec

from autograder.safe_files import keep_whole, write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path


INBOX_FOLDER = "inbox"
BY_HAND = "by hand"
"""The value of ``form`` for files that a person has put into ``submitted``."""
_LIST = "delivery.json"
SHORT_KEY = 11
"""The number of characters of a key that messages show."""


@dataclass(frozen=True)
class Arrival:
    """A file that came in a delivery.

    Attributes:
        source: The name of the zip in which it came; empty for a folder or a single file.
        parts: The path inside the zip. For a file inside a student's archive, the path of that archive.
        inner: The path inside the student's archive; the student chose this path.
        content: The hash of the bytes; empty if they could not be read.
        refused: The reason why the bytes could not be read; empty if they could be read.
        levels: The number of names, from the top of the path, that may name a student.
        is_list: True if the file is a list made by the system and not a student's work.
        is_archive: True if the file is a student's archive. The files in the archive have arrivals of their own.
    """

    source: str
    parts: tuple[str, ...]
    inner: tuple[str, ...] = ()
    content: str = ""
    refused: str = ""
    levels: int = 1
    is_list: bool = False
    is_archive: bool = False

    @property
    def is_alone(self) -> bool:
        """True if the instructor named this very file, or archive, so that its name may be the student's."""
        return not self.source and len(self.parts) == 1

    @property
    def name(self) -> str:
        """The name of the file without its path."""
        return (self.source, *self.parts, *self.inner)[-1]

    @property
    def path(self) -> str:
        """The path of the file without the name of the zip."""
        return "/".join((*self.parts, *self.inner))

    @property
    def label(self) -> str:
        """The name of the file for messages."""
        return "/".join(part for part in (self.source, self.path) if part)

    @property
    def key(self) -> str:
        """The identity of the file: the same for all files with equal bytes and an equal path, and for no others."""
        named = f"{self.content}\0{self.path or self.source}".encode("utf-8", "replace")
        return f"#{hashlib.sha256(named).hexdigest()}"


@dataclass(frozen=True)
class Delivery:
    """The files that one command took in, with its options.

    Attributes:
        arrivals: The files.
        form: The system that the instructor named, or :data:`BY_HAND`; empty if the names show it.
        names: The pattern given with ``--names``.
        zone: The time zone given with ``--timezone``; empty for that of the class.
        assignment: The assignment given with ``--assignment``.
        handed_in: The time given with ``--handed-in``.
        student: The student given with ``--student``, to whom all files belong.
    """

    arrivals: tuple[Arrival, ...]
    form: str = ""
    names: str = ""
    zone: str = ""
    assignment: str = ""
    handed_in: datetime | None = None
    student: str = ""

    @property
    def id(self) -> str:
        """Return the id of the delivery, which is equal for equal files and options in any order."""
        return hashlib.sha256(msgspec.json.encode(self)).hexdigest()


class Inbox:
    """The deliveries of a class.

    Args:
        state: The class's folder for the autograder's own files.
    """

    def __init__(self, state: Path) -> None:
        self._folder = state / INBOX_FOLDER
        self._where: dict[str, Path] = {}
        self._deliveries: dict[str, Delivery] = {}
        for path in sorted(self._folder.glob("*.zip")):
            with zipfile.ZipFile(path) as archive:
                delivery = msgspec.json.decode(archive.read(_LIST), type=Delivery)
                self._deliveries[delivery.id] = delivery
                self._where |= {name: path for name in archive.namelist() if name != _LIST}

    @property
    def deliveries(self) -> dict[str, Delivery]:
        """Return all deliveries by their ids, in an order that does not depend on when they came."""
        return dict(sorted(self._deliveries.items()))

    @property
    def keys(self) -> set[str]:
        """Return the keys of all files."""
        return {file.key for delivery in self._deliveries.values() for file in delivery.arrivals}

    @property
    def contents(self) -> set[str]:
        """Return the hashes of the bytes of all files."""
        return set(self._where)

    def __contains__(self, content: str) -> bool:
        return content in self._where

    def read(self, content: str) -> bytes:
        """Return the bytes with this hash.

        Raises:
            KeyError: The inbox does not contain them.
        """
        with zipfile.ZipFile(self._where[content]) as archive:
            return archive.read(content)

    @contextlib.contextmanager
    def receiving(self) -> Iterator[Receiving]:
        """Take in a delivery within a ``with`` block, and store it if the block ends without an error.

        Raises:
            OSError: The delivery could not be written.
        """
        self._folder.mkdir(parents=True, exist_ok=True)
        beside = self._folder / f".delivery.{secrets.randbelow(10**12)}.new"
        try:
            with zipfile.ZipFile(beside, "x", zipfile.ZIP_DEFLATED) as archive:
                receiving = Receiving(self, archive)
                yield receiving
                delivery = receiving.delivery
                archive.writestr(_LIST, msgspec.json.encode(delivery))
            path = self._folder / f"{delivery.id}.zip"
            if delivery.arrivals and delivery.id not in self._deliveries:
                keep_whole(beside, path)
                self._deliveries[delivery.id] = delivery
                self._where |= dict.fromkeys(receiving.new, path)
        finally:
            beside.unlink(missing_ok=True)


class Receiving:
    """A delivery while it is being taken in.

    Attributes:
        delivery: The files with the options of the command, to be set before the block ends.
        new: The hashes of bytes that the inbox did not have before.
    """

    def __init__(self, inbox: Inbox, archive: zipfile.ZipFile) -> None:
        self._inbox = inbox
        self._archive = archive
        self.delivery = Delivery(())
        self.new: set[str] = set()

    def keep(self, data: bytes) -> str:
        """Store these bytes in the inbox, and return their hash."""
        content = hashlib.sha256(data).hexdigest()
        if content not in self._inbox and content not in self.new:
            self.new.add(content)
            self._archive.writestr(zipfile.ZipInfo(content), data, zipfile.ZIP_DEFLATED)
        return content


Place = tuple[str, str, str]
"""The place of a notebook in ``submitted``: the student's id, and the names of the assignment and the notebook."""


class LineState(StrEnum):
    """The state of a file after collecting. Each file has exactly one state."""

    PLACED = "placed"
    """The file is graded, and is in ``submitted``. In a report, the state also means that this command has written the
    file.
    """
    UNCHANGED = "unchanged"
    """Another file with the same bytes is graded. In a report, the state may also mean that the file itself is graded,
    and was in ``submitted`` before this command.
    """
    EARLIER = "earlier"
    """Another file is graded, so this file is kept as an earlier attempt."""
    BESIDE = "beside"
    """The file is not a notebook to collect, and needs no decision: its student has also handed in a notebook, or the
    LMS made the file.
    """
    NOT_PLACED = "not placed"
    """The file waits for a person, because it may be a student's work."""
    LEFT_OUT = "left out"
    """A person wrote ``no`` under ``use``."""


@dataclass(frozen=True)
class Line:
    """A line of ``collected.csv``.

    Attributes:
        key: The key that identifies the line in ``collected.csv``.
        label: The name of the file in messages.
        content: The hash of the file's bytes.
        students: The ids of the students to whom the file belongs; empty if they are unknown.
        assignment: The name of the assignment; empty if it is unknown.
        notebook: The name of the notebook; empty if it is unknown, or if the file is not a notebook.
        when: The time of handing in, in UTC; in a report, in the time zone of the class.
        unreadable: Why the file cannot be read as a notebook; empty if it can be read, or was not read.
        first: The first time at which the same file came, in UTC.
        time_from: The key of the list, or the word ``handed_in`` if a person wrote the time; else empty.
        order: A number that increases with later files of one student, if the system numbers files.
        late: True if the system marks the file as late.
        use: ``yes`` or ``no``, as a person wrote it; empty if no person did.
        state: The decision about the file.
        reason: Why the file is not graded, and what to do.
        is_soft: True if the file, such as a picture, needs no attention once a notebook of its student was collected.
        lms, number, name, file: The system, and the student and the file as the system calls them. Feedback for the
            system uses these names.
        is_named: True if the file has the name of the notebook.
        is_sure: True if a number of the system identifies the student, not just a name that students may choose.
        via: The system from which the file came that a person corrected; ``number``, ``name`` and ``file`` are its.
        came_in: The downloads that contained the file.
        rank: If a file came several times, the line with the lowest rank is preferred. The rank is lower if the command
            named the system, and higher if the command named the assignment.
    """

    key: str
    label: str
    content: str = ""
    students: tuple[str, ...] = ()
    assignment: str = ""
    notebook: str = ""
    when: datetime | None = None
    order: int = 0
    late: bool = False
    use: str = ""
    state: LineState = LineState.NOT_PLACED
    reason: str = ""
    is_soft: bool = False
    lms: str = ""
    number: str = ""
    name: str = ""
    file: str = ""
    is_named: bool = False
    is_sure: bool = False
    came_in: frozenset[str] = field(default_factory=frozenset)
    rank: int = 0
    unreadable: str = ""
    first: datetime | None = None
    time_from: str = ""
    via: str = ""

    @property
    def student(self) -> str:
        """The id of the student; empty if it is unknown, or if the file belongs to several."""
        return self.students[0] if len(self.students) == 1 else ""

    @property
    def place(self) -> Place:
        """The student, the assignment and the notebook for which the file was handed in."""
        return self.student, self.assignment, self.notebook

    @property
    def is_by_hand(self) -> bool:
        """True if a person put the file into ``submitted``."""
        return self.lms == BY_HAND


RECORDS_FOLDER = "collected"


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
        self._folder = state / RECORDS_FOLDER

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

    def rename(self, ids: Mapping[str, str]) -> None:
        """Give students other ids. If a student has a record under both ids, the one under the new id stays.

        Args:
            ids: The new ids by the old ones. No new id may be one of the old ones.

        Raises:
            OSError: A record could not be written.
        """
        for student, assignment in ((old, name) for old, name in self.all() if old in ids):
            new, history = ids[student], self.get(assignment, student)
            if history and self.get(assignment, new) is None:
                now = {name: replace(line, students=(new,)) for name, line in history.now.items()}
                self.put(assignment, new, replace(history, now=now))
            self._path(assignment, student).unlink()

    def _path(self, assignment: str, student: str) -> Path:
        return self._folder / assignment / f"{student}.json"
