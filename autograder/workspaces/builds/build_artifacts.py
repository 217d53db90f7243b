"""Takes the result of a build out of a box, as regular files and folders and nothing else.

A student's code can put anything into the install folder of a build. So the folder is packed in the box as a list of
typed entries, and outside the box every entry is checked before it is written. Links are replaced by copies of their
targets, because otherwise a program might follow a link out of the folder.

In a box, this module is a program that prints the packed folder:
``python -m autograder.workspaces.builds.build_artifacts FOLDER``.
"""

from __future__ import annotations

import errno
import os
import shutil
import stat
import sys
from enum import StrEnum
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Annotated

import msgspec

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


MAX_FILES = 5_000
MAX_BYTES = 64_000_000
MOST_ENTRIES = 100_000
"""The maximum number of entries to decode. Millions of tiny entries fit into an archive, but take a gigabyte of memory.
The box of a build cannot have so many files.
"""
BLOCK = 4_096
"""Bytes that are added to the size of each file and folder, so that thousands of empty files exceed the limit, too."""
MAX_NAME = 240
"""The maximum length of one name in a path, in bytes."""
MAX_DEPTH = 24
"""The maximum number of names in a path."""
MAX_LINKS = 8
"""The maximum number of symbolic links in a chain in which each link leads to the next."""
_OF_THIS_MACHINE = (
    errno.ENOSPC,
    errno.EDQUOT,
    errno.EMFILE,
    errno.ENFILE,
    errno.ENOMEM,
    errno.EIO,
    errno.EROFS,
)
"""Error numbers for trouble of this machine that no build can cause, such as a full disk or too many open files."""


class BadArtifacts(ValueError):
    """The packed folder is invalid, or contains something that no build of a workspace makes."""


class Kind(StrEnum):
    """The type of an entry in an install folder."""

    FILE = "file"
    PROGRAM = "program"
    FOLDER = "folder"
    LINK = "link"
    OTHER = "other"


class PackedEntry(msgspec.Struct, frozen=True, array_like=True):
    """One file, folder or link.

    Attributes:
        path: The path inside the install folder, as bytes, because it may not be valid UTF-8.
        kind: The type. A program is a file that its owner may execute.
        data: The content of a file, or the target of a link.
    """

    path: bytes
    kind: Kind
    data: bytes = b""


_Entries = Annotated[list[PackedEntry], msgspec.Meta(max_length=MOST_ENTRIES)]


def pack(install: Path) -> bytes:
    """Pack an install folder as a list of :class:`PackedEntry`, in MessagePack; empty if missing or too large."""
    entries, size = [], 0
    try:
        for path in _below(install):
            entries.append(_entry(path, install))
            size += len(entries[-1].data)
            if size > MAX_BYTES:
                return b""
    except (OSError, RecursionError):
        return b""
    return msgspec.msgpack.encode(entries)


def _below(folder: Path) -> Iterator[Path]:
    for entry in sorted(os.scandir(folder), key=lambda entry: entry.name):
        path = Path(entry.path)
        yield path
        if entry.is_dir(follow_symlinks=False):
            yield from _below(path)


def _entry(path: Path, install: Path) -> PackedEntry:
    name, mode = os.fsencode(path.relative_to(install)), path.lstat().st_mode
    if stat.S_ISDIR(mode):
        return PackedEntry(name, Kind.FOLDER)
    if stat.S_ISLNK(mode):
        return PackedEntry(name, Kind.LINK, os.fsencode(path.readlink()))
    if not stat.S_ISREG(mode):
        return PackedEntry(name, Kind.OTHER)
    return PackedEntry(name, Kind.PROGRAM if mode & stat.S_IXUSR else Kind.FILE, path.read_bytes())


def unpack(packed: bytes, folder: Path, most: int = MAX_BYTES) -> None:
    """Check a packed install folder, and write it into a new folder.

    Args:
        packed: The result of :func:`pack`; but a student's code may have written any bytes instead.
        folder: The folder to create. It must not exist yet.
        most: The maximum size in bytes of all files and folders together.

    Raises:
        BadArtifacts: An entry leads out of the folder or is a device, a link does not lead to a file of the build, or
            there are too many files or bytes. The files that were written before the error stay.
        OSError, MemoryError: The disk, memory or open files of this machine are used up, so the build is not at fault.
    """
    if not packed:
        raise BadArtifacts("the result of the build could not be packed")
    folder.mkdir(mode=0o755)
    try:
        _write(msgspec.msgpack.decode(packed, type=_Entries), folder, most)
    except (msgspec.MsgspecError, OSError) as error:
        if getattr(error, "errno", None) in _OF_THIS_MACHINE:
            raise
        raise BadArtifacts(f"the result of the build cannot be read: {error}") from error


def _write(entries: list[PackedEntry], folder: Path, most: int) -> None:
    size = 0
    made: set[PurePosixPath] = set()
    links: dict[PurePosixPath, PurePosixPath] = {}
    for number, entry in enumerate(entries, 1):
        place = _place(entry.path)
        size += 0 if entry.kind is Kind.LINK else len(entry.data)
        made.update((place, *place.parents))
        check_room(size + len(made) * BLOCK, most, number)
        if entry.kind is Kind.LINK:
            links[place] = _target(place, entry)
        else:
            _take(entry, folder / place)
    for link in links:
        size += _copy(link, links, folder)
        check_room(size + len(made) * BLOCK, most, len(entries))


def check_room(size: int, most: int, number: int = 0) -> None:
    """Check that the files that a build made do not exceed the limits.

    Args:
        size: The size of all files and folders together in bytes.
        most: The maximum size in bytes.
        number: The number of files and folders.

    Raises:
        BadArtifacts: A limit is exceeded.
    """
    if number > MAX_FILES or size > most:
        raise BadArtifacts(
            f"the build is too large: it may have at most {MAX_FILES} files and folders, and {most // 1000} kB of "
            "space are left for it"
        )


def _take(entry: PackedEntry, place: Path) -> None:
    if entry.kind is Kind.FOLDER:
        place.mkdir(parents=True, exist_ok=True)
        return
    if os.path.lexists(place):
        raise BadArtifacts(f"{os.fsdecode(entry.path)!r:.80} occurs twice in the result of the build")
    if entry.kind is Kind.OTHER:
        raise BadArtifacts(f"{os.fsdecode(entry.path)!r:.80} is neither a file nor a folder")
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_bytes(entry.data)
    place.chmod(0o755 if entry.kind is Kind.PROGRAM else 0o644)


def _place(name: bytes) -> PurePosixPath:
    """Return the path of an entry inside the install folder."""
    path = PurePosixPath(os.fsdecode(name))
    parts = path.parts
    if (
        not parts
        or path.is_absolute()
        or b"\0" in name
        or ".." in parts
        or len(parts) > MAX_DEPTH
        or any(len(os.fsencode(part)) > MAX_NAME for part in parts)
    ):
        raise BadArtifacts(f"{os.fsdecode(name)!r:.80} is not a path inside the install folder")
    return path


def _target(place: PurePosixPath, link: PackedEntry) -> PurePosixPath:
    """Return the target of a link as a path inside the install folder.

    The path is computed without looking at the disk, which is correct because the written folder contains no links.
    """
    inside = os.path.normpath(place.parent / os.fsdecode(link.data))
    if inside.startswith(("..", "/")) or "\0" in inside:
        raise BadArtifacts(f"{os.fsdecode(link.path)!r:.80} leads out of the install folder")
    return PurePosixPath(inside)


def _copy(link: PurePosixPath, links: Mapping[PurePosixPath, PurePosixPath], folder: Path) -> int:
    """Write a copy of the file to which a link leads, directly or through other links. Return its size in bytes."""
    target = link
    for _ in range(MAX_LINKS):
        target = links.get(target, target)
    place, source = folder / link, folder / target
    if target in links or not source.is_file():
        raise BadArtifacts(f"{str(link)!r} is a link that does not lead to a file of the build")
    if os.path.lexists(place):
        raise BadArtifacts(f"{str(link)!r} occurs twice in the result of the build")
    place.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(source, place)
    return place.stat().st_size


if __name__ == "__main__":
    sys.stdout.buffer.write(pack(Path(sys.argv[1])))
