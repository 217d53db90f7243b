"""Reads the files that ``collect`` is given: archives, folders and lists from an LMS.

A desk, a process in a box, unpacks each archive and parses each list, so that this process parses none of their bytes.
For an archive, the desk writes all files, within limits, into one file on the disk, as
:mod:`autograder.grading.collecting.archive_unpacking` describes. This module treats each name in it as text only,
reads bytes up to the size limit of a notebook, and gives a reason for each file that cannot be taken.
"""

from __future__ import annotations

import contextlib
import errno
import functools
import itertools
import os
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, NamedTuple, Self

from autograder.boxes.admission import NotAdmitted, admitted
from autograder.boxes.box_connection import ChannelClosed
from autograder.boxes.reading_desks import in_memory
from autograder.boxes.sandbox import why_impossible
from autograder.grading.collecting.archive_unpacking import LONGEST_LINE, LONGEST_NAME, is_left_by_a_program
from autograder.grading.collecting.collected_files import Arrival
from autograder.grading.collecting.lms_lists import ListEntry
from autograder.grading.rebuilding.file_desk import desk
from autograder.grading.rebuilding.submitted_notebook import MAX_BYTES, UnreadableSubmission, read_bytes
from autograder.safe_files import name_as_text, opened, unnamed_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


_CPU_SECONDS = 200
"""The limit in seconds of the processor time for one archive, or one list."""


def without_sandbox() -> str:
    """Return why archives or lists were read without a sandbox; empty if nothing was read without a sandbox."""
    return why_impossible() if desk.is_unboxed else ""


_LARGEST_LIST = 50_000_000
"""The limit in bytes of the answer about a list."""


@functools.lru_cache(maxsize=16)  # one command needs each list several times
def read_list(name: str, data: bytes) -> list[ListEntry] | None:
    """Return the entries of a list; None if its form is unknown, or if a limit was exceeded.

    Args:
        name: The file's name.
        data: The bytes of the file.
    """
    try:
        entries: list[ListEntry] | None = desk.read(
            "list", data, list[ListEntry] | None, most=_LARGEST_LIST, seconds=_CPU_SECONDS, name=name
        )
    except (NotAdmitted, ChannelClosed):
        return None
    return entries


class NotTaken(ValueError):
    """A file or archive cannot be taken, for the reason in the message."""


class File(NamedTuple):
    """A file in an archive or folder: what is known about it, and a function that reads it.

    The function reads up to the size limit of a notebook, and raises :class:`NotTaken`.
    """

    arrival: Arrival
    read: Callable[[], bytes]


@dataclass
class Room:
    """Limits on unpacking. The defaults apply to the total of one student's archives in a download.

    Attributes:
        files: The maximum number of files.
        unpacked: The maximum number of bytes.
    """

    files: int = 5_000
    unpacked: int = 1_000_000_000


MOST_FILES = 20_000
"""The maximum number of files in one student's folder. Files are counted by the first three folders of their paths, so
that a huge repository of one student does not affect other students.
"""
_DEEPEST = 3
"""The maximum number of archives inside each other, counting the one that the student handed in."""
_DEEPEST_FOLDER = 100
"""The maximum number of folders inside each other: ``os.walk`` fails at some hundreds."""


class Archives:
    """Opens archives, as a context manager. Unpacked bytes stay on the disk until the ``with`` block ends.

    Args:
        disk: A folder on a disk with enough space for the unpacked bytes.
    """

    def __init__(self, disk: Path) -> None:
        self._disk = disk
        self._stack = contextlib.ExitStack()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def files_of(self, source: Path, *, is_opened: bool = True) -> Iterator[File]:
        """Yield the files in an archive or folder, or the file itself.

        An unreadable file is yielded, too: its function ``read`` raises the error.

        Args:
            source: A file or folder that the instructor named, which may be a link. But links inside the folder are not
                followed.
            is_opened: True to unpack an archive and yield its files; False to yield the archive itself as a file.
        """
        counts: Counter[tuple[str, ...]] = Counter()
        for file in self._of_source(source.absolute(), is_opened=is_opened):
            folder = file.arrival.parts[:-1][:3] or file.arrival.parts
            counts[folder] += 1
            if counts[folder] <= MOST_FILES:
                yield file
            elif counts[folder] == MOST_FILES + 1:
                reason = f"the folder has more than {MOST_FILES} files; the other files were not read"
                yield File(replace(file.arrival, parts=folder), _refusing(reason))

    def _of_source(self, source: Path, *, is_opened: bool) -> Iterator[File]:
        name = name_as_text(source.name)
        if source.is_dir():
            yield from _of_folder(source)
        elif source.suffix.lower() == ".zip" and is_opened:
            room = Room(2_000_000, 50_000_000_000)
            out = self._stack.enter_context(unnamed_file(self._disk))
            try:
                archive = self._stack.enter_context(opened(source.resolve()))
            except OSError as error:
                yield File(Arrival(name, ()), _refusing(f"it cannot be read: {error.strerror}"))
                return
            for names, read in _unpacked(archive.fileno(), room, 1, out):
                yield File(Arrival(name, _path(names[-1]) if names else ()), read)
        else:
            yield File(Arrival("", (name,)), functools.partial(_read_file, source))

    def within(self, arrival: Arrival, data: bytes, room: Room) -> Iterator[File]:
        """Yield the files in a student's archive, and in archives inside it. Read each file before taking the next.

        Args:
            arrival: The archive.
            data: The bytes of the archive.
            room: The remaining limits for this student's archives. They are reduced here.
        """
        with in_memory(data) as archive, unnamed_file(self._disk) as out:
            for names, read in _unpacked(archive, room, _DEEPEST, out):
                inner = tuple(part for name in names for part in _path(name))
                yield File(replace(arrival, inner=inner, content=""), read)


def _of_folder(source: Path) -> Iterator[File]:
    for folder, folders, names in os.walk(source):
        here = tuple(map(name_as_text, Path(folder).relative_to(source.parent).parts))
        folders[:] = sorted(name for name in folders if not is_left_by_a_program(name))
        for name in sorted(names):
            path = Path(folder) / name
            if is_left_by_a_program(name):
                continue
            yield File(Arrival("", (*here, name_as_text(name))), functools.partial(_read_file, path))
        for name in folders:
            if (Path(folder) / name).is_symlink():
                yield File(Arrival("", (*here, name_as_text(name))), _refusing("it is a link"))
        if folders and len(here) > _DEEPEST_FOLDER:
            folders.clear()
            reason = f"folders are nested more than {_DEEPEST_FOLDER} deep; the deeper folders were not read"
            yield File(Arrival("", here), _refusing(reason))


def _read_file(path: Path) -> bytes:
    try:
        return read_bytes(path)
    except UnreadableSubmission as error:
        raise NotTaken(str(error)) from error


def _refusing(reason: str) -> Callable[[], bytes]:
    def read() -> bytes:
        raise NotTaken(reason)

    return read


def _unpacked(
    archive: int, room: Room, depth: int, out: IO[bytes]
) -> Iterator[tuple[tuple[str, ...], Callable[[], bytes]]]:
    """Unpack an archive. Yield, for each file, the names that lead to it and a function that reads it."""
    most = max(room.unpacked, 0) + max(room.files + 1, 1) * LONGEST_LINE
    limits = {"depth": depth, "files": room.files, "unpacked": room.unpacked, "of_one": MAX_BYTES}
    try:
        desk.ask("archive", archive, out.fileno(), most=most, seconds=_CPU_SECONDS, **limits)
    except (NotAdmitted, ChannelClosed) as error:
        if isinstance(error, NotAdmitted) and error.code in (errno.ENOSPC, errno.EDQUOT):
            raise OSError(error.code, os.strerror(error.code)) from error
        yield (), _refusing("unpacking the archive would exceed a limit: unpack it, and collect the folder")
        return
    for line, begin in itertools.islice(_lines(out), room.files + 1):
        room.files -= not line.reason
        room.unpacked -= line.size
        read = functools.partial(os.pread, out.fileno(), line.size, begin)
        yield line.names, _refusing(line.reason) if line.reason else read


@dataclass(frozen=True)
class _Unpacked:
    """A line of the desk's answer, as :mod:`autograder.grading.collecting.archive_unpacking` describes it."""

    names: tuple[str, ...]
    size: int
    reason: str = ""


def _lines(out: IO[bytes]) -> Iterator[tuple[_Unpacked, int]]:
    """Yield the descriptions of files in the answer of a desk, each with the position of the file's bytes."""
    place, end = 0, os.fstat(out.fileno()).st_size
    while place < end:
        line, mark, _ = os.pread(out.fileno(), LONGEST_LINE, place).partition(b"\n")
        try:
            found: _Unpacked = admitted(line, _Unpacked, LONGEST_LINE)
        except NotAdmitted:
            # The rest is not read: it may be the content of a file that looks like such a line.
            yield _Unpacked((), 0, "the output of the box is not a list of files"), end
            return
        place += len(line) + len(mark)
        size = min(max(found.size, 0), MAX_BYTES)
        yield replace(found, size=size), place
        place += size


def _path(name: str) -> tuple[str, ...]:
    """Return the path of a file in an archive as a tuple of names, without ``..``. This path is never written to."""
    parts = name[:LONGEST_NAME].replace("\\", "/").split("/")
    return tuple(part for part in parts if part not in ("", ".", "..")) or (name[:LONGEST_NAME],)
