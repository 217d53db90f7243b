"""Reading zips and folders without believing them: nothing is ever extracted, only read up to a limit.

A zip may name places outside of itself, be a link, want a password, or unpack to more than any disk holds. Here a
file's name is only text, its bytes are read into memory as far as a notebook may go, and whatever cannot be taken has
a reason.
"""

from __future__ import annotations

import functools
import hashlib
import io
import itertools
import os
import stat
import struct
import zipfile
import zlib
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from autograder.grading.rebuilding.submission import MAX_BYTES, UnreadableSubmission, read_bytes
from autograder.regular_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

MOST_FILES = 20_000
"""In one folder of a download: a student whose folder is full, such as a repository, harms nobody else."""
_LARGEST_LIST = 8_000_000
"""Bytes of an archive's list of files, which Python reads whole before anybody can count them: 400 a file."""
_LARGEST_LIST_OF_ONE = 300_000
"""The same for an archive that a student has handed in."""
_OTHER_METHODS = {9: "Deflate64", 12: "bzip2", 14: "LZMA", 93: "Zstandard", 95: "xz", 98: "PPMd"}
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Others (bzip2, LZMA) unpack a few hundred bytes to a gigabyte in one step, before anybody can stop them."""
_BROKEN = (
    ArithmeticError,
    EOFError,
    LookupError,
    OSError,
    RuntimeError,
    ValueError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)
"""What Python raises of archives that say what cannot be: a place before the beginning, a name in no letters."""
_DEEPEST = 3
"""Archives in an archive that a student has handed in, one in the other."""
_DEEPEST_FOLDER = 100
"""Folders in each other; Python looks into no more than some hundreds."""
_LEFT_BY_PROGRAMS = ("__MACOSX", ".git", ".ipynb_checkpoints", "__pycache__", ".DS_Store")
"""Files that systems and editors leave beside a student's work."""
EMPTY = "holds no file, or only what programs leave beside a work"
"""Said of an archive or a folder of which nothing is taken."""
_LEADS_OUT = "its name leads out of the archive"
_LONGEST_NAME = 1_000
"""Characters of a path; a zip may have paths of 65,535, too many to print."""
_TOO_LONG = f"its name has more than {_LONGEST_NAME} characters"


class NotTaken(ValueError):
    """A file or archive cannot be taken; the message says why."""


@dataclass(frozen=True)
class File:
    """A file of an archive or folder.

    Attributes:
        source: The archive, or the folder that the named folder or file is in.
        parts: Its path in there, without anything that leads upwards; of what is in an archive that a student has
            handed in, the path of that archive.
        read: Reads it, up to the limit of a notebook; raises :class:`NotTaken`.
        inner: The path within an archive that a student has handed in: the student chose it.
        content: The hash of its bytes; empty where nobody has read them.
    """

    source: Path
    parts: tuple[str, ...]
    read: Callable[[], bytes]
    inner: tuple[str, ...] = ()
    content: str = ""

    @property
    def label(self) -> str:
        """Its name in messages."""
        parts = (*self.parts, *self.inner)
        return "/".join(parts if self.source.is_dir() else (name_as_text(self.source.name), *parts))

    def holding(self, data: bytes) -> File:
        """The same file, and what it holds is known."""
        return replace(self, content=hashlib.sha256(data).hexdigest())

    @property
    def name(self) -> str:
        """The name of the file itself."""
        return (self.source.name, *self.parts, *self.inner)[-1]


@dataclass
class Room:
    """The room that all archives of one student in a download still have together.

    Attributes:
        files: The number of files.
        unpacked: The number of bytes, as the archives themselves say it.
    """

    files: int = 5_000
    unpacked: int = 1_000_000_000

    def take(self, entries: Sequence[zipfile.ZipInfo]) -> str:
        """Take room for the files of one more archive; the reason why there is none, or an empty text."""
        size = sum(entry.file_size for entry in entries)
        if len(entries) > self.files or size > self.unpacked:
            return (
                f"it has {len(entries)} files that unpack to {size / 1e6:.0f} MB: with the student's other archives, "
                f"more than {Room.files} files or {Room.unpacked / 1e6:.0f} MB. Ask for the notebook alone"
            )
        self.files -= len(entries)
        self.unpacked -= size
        return ""


def files_of(source: Path, *, opened: bool = True) -> Iterator[File]:
    """The files of an archive, of a folder, or the file itself; one that cannot be read says so when it is read.

    Args:
        source: A file or folder that the instructor named. It may be a link; nothing below it may.
        opened: Whether an archive is opened here; otherwise it is a file, as in a download.
    """
    counts: Counter[tuple[str, ...]] = Counter()
    levels = 2 + _has_one_folder_around_all(source)
    for file in _of_source(source.absolute(), opened=opened):
        folder = file.parts[:levels]
        counts[folder] += 1
        if counts[folder] <= MOST_FILES:
            yield file
        elif counts[folder] == MOST_FILES + 1:
            reason = f"it has more than {MOST_FILES} files; the others in it were not looked at"
            yield File(file.source, folder, _refusing(reason))


def _has_one_folder_around_all(source: Path) -> bool:
    """True of a folder with a single folder in it: an archive is often unpacked into one of its own name."""
    try:
        inside = [path for path in source.iterdir() if not _is_left_by_a_program(path.name)]
    except OSError:  # also where it is a file
        return False
    return len(inside) == 1 and inside[0].is_dir()


def _is_left_by_a_program(name: str) -> bool:
    return name in _LEFT_BY_PROGRAMS or name.startswith("._")


def _of_source(source: Path, *, opened: bool) -> Iterator[File]:
    if source.is_dir():
        yield from _of_folder(source)
        return
    alone = File(source.parent, (name_as_text(source.name),), functools.partial(_read_file, source))
    if source.suffix.lower() != ".zip" or not opened:
        yield alone
        return
    try:
        file = source.open("rb")
    except OSError as error:
        yield replace(alone, read=_refusing(f"it cannot be read: {error.strerror}"))
    else:
        yield from _of_zip(File(source, (), alone.read), file, _LARGEST_LIST)


def within(file: File, data: bytes, room: Room, depth: int = 1) -> Iterator[tuple[File, bytes | NotTaken]]:
    """The files of an archive that a student has handed in, those of archives in it, too.

    With each comes what it holds, or the reason why that cannot be taken.
    """
    holds_a_file = False
    for inner in _of_zip(file, io.BytesIO(data), _LARGEST_LIST_OF_ONE, room):
        holds_a_file = True
        try:
            held = inner.read()
        except NotTaken as reason:
            yield inner, reason
            continue
        if is_zip(inner.name, held) and depth < _DEEPEST:
            yield from within(inner, held, room, depth + 1)
        else:
            yield inner, held
    if not holds_a_file:
        yield file, NotTaken(f"it {EMPTY}")


def _of_folder(source: Path) -> Iterator[File]:
    above = source.parent
    for folder, folders, names in os.walk(source):
        here = tuple(map(name_as_text, Path(folder).relative_to(above).parts))
        folders[:] = sorted(name for name in folders if name not in _LEFT_BY_PROGRAMS)
        for name in sorted(names):
            path = Path(folder) / name
            if _is_left_by_a_program(name):
                continue
            yield File(above, (*here, name_as_text(name)), functools.partial(_read_file, path))
        for name in folders:
            if (Path(folder) / name).is_symlink():
                yield File(above, (*here, name_as_text(name)), _refusing("it is a link"))
        if folders and len(here) > _DEEPEST_FOLDER:
            folders.clear()
            reason = f"more than {_DEEPEST_FOLDER} folders are in each other; the others were not looked at"
            yield File(above, here, _refusing(reason))


def _of_zip(outer: File, data: BinaryIO, largest_list: int, room: Room | None = None) -> Iterator[File]:
    """The files of an archive; one that says why where it cannot be read."""
    try:
        bounded = _Bounded(data, largest_list)
        archive = zipfile.ZipFile(bounded)
        bounded.most = MAX_BYTES + 1  # from here on, the files themselves
        entries = [entry for entry in archive.infolist() if not entry.is_dir()]
    except _BROKEN as error:
        reason = f"it is no zip file that can be read: {error}"
        if room is None and isinstance(error, NotTaken):
            reason += ". Unpack it, and collect the folder"  # one student's many names are no reason to lose all others
        yield replace(outer, read=_refusing(reason))
        return
    if room is not None and (reason := room.take(entries)):
        yield replace(outer, read=_refusing(reason))
        return
    for entry in entries:
        name = _name_of(entry)
        parts = tuple(part for part in name.replace("\\", "/").split("/") if part not in ("", "."))
        if any(map(_is_left_by_a_program, parts)):
            continue
        reason = _reason_against(entry, name, parts)
        # The archive stays open as long as any of its files may be read.
        read = _refusing(reason) if reason else functools.partial(_read_entry, archive, entry)
        if reason in (_LEADS_OUT, _TOO_LONG):  # the system's own folders in front of it stay what they are
            above = itertools.takewhile(lambda part: part != "..", parts[:-1][:2])
            parts = (*(part[:_LONGEST_NAME] for part in above), name[:_LONGEST_NAME])
        if outer.parts:
            yield File(outer.source, outer.parts, read, (*outer.inner, *parts))
        else:
            yield File(outer.source, parts, read)


def is_zip(name: str, data: bytes) -> bool:
    """True if a file that was handed in is an archive to be opened, whatever is behind its name.

    Documents of office programs are zips, too, and hold no notebook.
    """
    suffixes = [suffix.lower() for suffix in Path(name).suffixes]
    return ".zip" in suffixes or (
        data.startswith(b"PK\x03\x04") and suffixes[-1:] in ([], [".txt"], [".bin"])
    )


def _refusing(reason: str) -> Callable[[], bytes]:
    def read() -> bytes:
        raise NotTaken(reason)

    return read


def _read_file(path: Path) -> bytes:
    try:
        return read_bytes(path)
    except UnreadableSubmission as error:
        raise NotTaken(str(error)) from error


class _Bounded:
    """A file that gives no more bytes at once than a limit.

    An archive may give several lengths for its list of files, and programs differ in the one that they believe. So the
    limit is on the bytes that are really read.

    Attributes:
        most: Bytes that may be read at once.
    """

    def __init__(self, file: BinaryIO, most: int) -> None:
        self._file = file
        self.most = most
        self.seek, self.tell, self.close = file.seek, file.tell, file.close

    def read(self, size: int = -1) -> bytes:
        """The content that ``read`` of any file gives.

        Raises:
            NotTaken: It is more than the limit.
        """
        data = self._file.read(self.most + 1 if size < 0 else min(size, self.most + 1))
        if len(data) > self.most:
            raise NotTaken(f"its list of files has more than {self.most / 1e6:.1f} MB")
        return data

    def seekable(self) -> bool:
        """True: it can be read from any place."""
        return True


def _name_of(entry: zipfile.ZipInfo) -> str:
    """The name as it was meant: many programs write UTF-8 and do not say so."""
    if entry.flag_bits & 0x800:
        return entry.filename
    try:
        return entry.filename.encode("cp437").decode("utf-8")
    except UnicodeError:
        return entry.filename


def _reason_against(entry: zipfile.ZipInfo, name: str, parts: tuple[str, ...]) -> str:
    mode = entry.external_attr >> 16
    if len(name) > _LONGEST_NAME:
        return _TOO_LONG
    if not parts or ".." in parts or name.startswith(("/", "\\")) or (parts and parts[0].endswith(":")):
        return _LEADS_OUT
    if stat.S_IFMT(mode) not in (0, stat.S_IFREG):
        return "it is a link, or no ordinary file"
    if entry.flag_bits & 0x1:
        return "it is encrypted; ask for it without a password"
    if entry.compress_type not in _METHODS:
        method = _OTHER_METHODS.get(entry.compress_type, f"method {entry.compress_type}")
        return f"it is packed with {method}, which is not unpacked here: pack it again as an ordinary zip (deflate)"
    if entry.file_size > MAX_BYTES:
        return f"it unpacks to {entry.file_size / 1e6:.0f} MB; the limit is {MAX_BYTES / 1e6:.0f} MB"
    return ""


def _read_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    try:
        with archive.open(entry) as file:
            # No more than it claims: zipfile unpacks as much as it is asked for, and cuts it afterwards.
            data = file.read(min(entry.file_size, MAX_BYTES) + 1)
    except _BROKEN as error:
        raise NotTaken(f"it cannot be unpacked: {error}") from error
    if len(data) > MAX_BYTES:
        raise NotTaken(f"it unpacks to more than {MAX_BYTES / 1e6:.0f} MB")
    return data
