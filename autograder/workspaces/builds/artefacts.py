"""Packs the files that a build made, and unpacks them safely: only as regular files and folders.

A build runs a student's code, so its archive may contain anything. A link in the archive (such as `libx.so`, which
leads to `libx.so.1`) is replaced by a copy of its target, so that no later reader of the folder follows a link.
"""

from __future__ import annotations

import errno
import io
import os
import shutil
import tarfile
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from collections.abc import Mapping

MAX_FILES = 5_000
MAX_BYTES = 64_000_000
BLOCK = 4_096
"""The number of bytes that is added for each file and folder, so that thousands of empty files also reach the limit."""
MAX_NAME = 240
"""The maximum length of one part of a path, in bytes."""
MAX_DEPTH = 24
"""The maximum number of parts of a path."""
MAX_LINKS = 8
"""The maximum number of links to follow, one after the other, until a file is reached."""
MAX_PAX = 2_000
"""The maximum size in bytes of a pax header of a tar archive; a header with a long path has some hundred bytes.

The limit is needed because Python searches the header in quadratic time: a few megabytes of digits would take hours.
"""


_OF_THIS_MACHINE = (
    errno.ENOSPC,
    errno.EDQUOT,
    errno.EMFILE,
    errno.ENFILE,
    errno.ENOMEM,
    errno.EIO,
    errno.EROFS,
)
"""Error numbers (errno) of faults of this machine, such as a full disk, for which the archive is not to blame."""


class BadArtefacts(ValueError):
    """The archive is invalid, or contains something that no build of a workspace makes."""


class _ShortHeaders(tarfile.TarInfo):
    """An entry of a tar file, read with a limit on the size of its headers."""

    @classmethod
    def frombuf(cls, buf: bytes | bytearray, encoding: str, errors: str) -> Self:
        found = super().frombuf(buf, encoding, errors)
        is_pax = found.type in (tarfile.XHDTYPE, tarfile.XGLTYPE, tarfile.SOLARIS_XHDTYPE)
        if is_pax and not 0 <= found.size <= MAX_PAX:
            raise BadArtefacts(
                f"the archive has a header of more than {MAX_PAX} bytes, or one of a negative size"
            )
        return found


def pack(install: Path) -> bytes:
    """Return an install folder as a tar archive; empty if the folder is missing or too large."""
    file, size = io.BytesIO(), 0

    def bounded(member: tarfile.TarInfo) -> tarfile.TarInfo:
        nonlocal size
        size += member.size
        if size > MAX_BYTES:
            raise BadArtefacts("the result of the build is too large to be packed")
        return member

    try:
        with tarfile.open(fileobj=file, mode="w") as tar:
            tar.add(install, arcname=".", filter=bounded)
    except (OSError, RecursionError, BadArtefacts):
        return b""
    return file.getvalue()


def unpack(archive: bytes, folder: Path, most: int = MAX_BYTES) -> None:
    """Unpack the archive of an install folder into a new folder.

    Args:
        archive: A tar file. It may contain anything, because the code that was built could have written it.
        folder: The folder to create. It must not exist yet.
        most: The maximum size in bytes of all files and folders together.

    Raises:
        BadArtefacts: The archive has entries that lead out of the folder, links to anything but its own files, devices,
            or too many files or bytes. Files written before the error stay.
        OSError, MemoryError: The disk, memory or open files of this machine are used up, which is not the build's
            fault.
    """
    if not archive:
        raise BadArtefacts("the result of the build could not be packed")
    folder.mkdir(mode=0o755)
    number = size = 0
    made: set[PurePosixPath] = set()
    links: dict[PurePosixPath, PurePosixPath] = {}
    try:
        with tarfile.open(fileobj=io.BytesIO(archive), mode="r:", tarinfo=_ShortHeaders) as tar:
            for member in tar:
                number += 1
                size += max(member.size, 0)
                place = PurePosixPath(*_parts(member.name))
                made.update((place, *place.parents))
                check_room(size + len(made) * BLOCK, most, number)
                if member.issym():
                    links[place] = _target(member)
                else:
                    _take(tar, member, folder)
        for link in links:
            size += _copy(link, links, folder)
            check_room(size + len(made) * BLOCK, most, number)
    except (tarfile.TarError, OSError, ValueError, RecursionError, MemoryError, OverflowError) as error:
        if (
            isinstance(error, (BadArtefacts, MemoryError))
            or getattr(error, "errno", None) in _OF_THIS_MACHINE
        ):
            raise
        raise BadArtefacts(f"the result of the build cannot be read: {error}") from error


def check_room(size: int, most: int, number: int = 0) -> None:
    """Check that the files that a build made do not exceed the limits.

    Args:
        size: The size of all files and folders together in bytes.
        most: The maximum size in bytes.
        number: The number of files and folders.

    Raises:
        BadArtefacts: A limit is exceeded.
    """
    if number > MAX_FILES or size > most:
        raise BadArtefacts(
            f"the build made too much: {MAX_FILES} files and folders, and {most // 1000} kB are left for it"
        )


def _take(tar: tarfile.TarFile, member: tarfile.TarInfo, folder: Path) -> None:
    place = folder.joinpath(*_parts(member.name))
    if member.isdir():
        place.mkdir(parents=True, exist_ok=True)
        return
    if os.path.lexists(place):
        raise BadArtefacts(f"{member.name!r} is there twice")
    place.parent.mkdir(parents=True, exist_ok=True)
    if member.type not in (tarfile.REGTYPE, tarfile.AREGTYPE):
        raise BadArtefacts(f"{member.name!r} is neither a file nor a folder")
    source = tar.extractfile(member)
    assert source is not None
    place.write_bytes(source.read())
    place.chmod(0o755 if member.mode & 0o100 else 0o644)


def _parts(name: str) -> tuple[str, ...]:
    path = PurePosixPath(name)
    parts = path.parts
    if (
        path.is_absolute()
        or "\0" in name
        or ".." in parts
        or len(parts) > MAX_DEPTH
        or any(len(os.fsencode(p)) > MAX_NAME for p in parts)
    ):
        raise BadArtefacts(f"{name[:80]!r} is not a path inside the install folder")
    return parts


def _target(member: tarfile.TarInfo) -> PurePosixPath:
    """Return the target of a link as a path inside the install folder.

    The target is computed from text alone. This is correct because the folder on the disk never contains links.
    """
    inside = os.path.normpath(PurePosixPath(*_parts(member.name)).parent / member.linkname)
    if inside.startswith(("..", "/")) or "\0" in inside:
        raise BadArtefacts(f"{member.name!r} leads out of the install folder")
    return PurePosixPath(inside)


def _copy(link: PurePosixPath, links: Mapping[PurePosixPath, PurePosixPath], folder: Path) -> int:
    """Write a copy of the file to which a link leads, directly or through other links. Return its size in bytes."""
    target = link
    for _ in range(MAX_LINKS):
        target = links.get(target, target)
    place, source = folder / link, folder / target
    if target in links or not source.is_file():
        raise BadArtefacts(f"{str(link)!r} is a link that leads to no file of the build")
    if os.path.lexists(place):
        raise BadArtefacts(f"{str(link)!r} is there twice")
    place.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(source, place)
    return place.stat().st_size
