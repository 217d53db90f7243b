"""The result of a build, taken over as data: regular files and folders, and nothing else.

Outside a box nothing that a box has made may be more than bytes. A link of the archive (a library has some, from its
name to the name with its version) becomes a copy of the file that it names: who reads the folder later follows none.
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
"""Bytes that each file and folder takes of a disk besides those of the file: also thousands of empty ones take room."""
MAX_NAME = 240
"""Bytes of each part of a path."""
MAX_DEPTH = 24
"""Parts of a path."""
MAX_LINKS = 8
"""Links that lead from one to the next."""
MAX_PAX = 2_000
"""Bytes of a pax header; one with a long path has some hundreds. Python searches it in a time that grows with the
square: hours for a few megabytes of digits."""


_OF_THIS_MACHINE = (
    errno.ENOSPC,
    errno.EDQUOT,
    errno.EMFILE,
    errno.ENFILE,
    errno.ENOMEM,
    errno.EIO,
    errno.EROFS,
)
"""What no archive can bring about: a full disk, a used-up quota, too many open files."""


class BadArtefacts(ValueError):
    """An archive that is none, or that holds what no build of a workspace makes."""


class _ShortHeaders(tarfile.TarInfo):
    """An entry of a tar file that says no more of itself in front than entries of a build do."""

    @classmethod
    def frombuf(cls, buf: bytes | bytearray, encoding: str, errors: str) -> Self:
        found = super().frombuf(buf, encoding, errors)
        is_pax = found.type in (tarfile.XHDTYPE, tarfile.XGLTYPE, tarfile.SOLARIS_XHDTYPE)
        if is_pax and not 0 <= found.size <= MAX_PAX:
            raise BadArtefacts(
                f"the archive says more than {MAX_PAX} bytes, or fewer than none, of one of its files"
            )
        return found


def pack(install: Path) -> bytes:
    """An install folder as an archive; empty where there is none, or too much in it. Only regular files are opened."""
    file, size = io.BytesIO(), 0

    def bounded(member: tarfile.TarInfo) -> tarfile.TarInfo:
        nonlocal size
        size += member.size
        if size > MAX_BYTES:
            raise BadArtefacts("the build made too much to be packed")
        return member

    try:
        with tarfile.open(fileobj=file, mode="w") as tar:
            tar.add(install, arcname=".", filter=bounded)
    except (OSError, RecursionError, BadArtefacts):
        return b""
    return file.getvalue()


def unpack(archive: bytes, folder: Path, most: int = MAX_BYTES) -> None:
    """Write an archive of a build's install folder.

    Args:
        archive: A tar file that may be anything: whoever was built could have written it.
        folder: A folder that is not there yet.
        most: Bytes that all files and folders may take together.

    Raises:
        BadArtefacts: It has entries that lead out of the folder, links to anything but one of its files, devices, or
            too much of anything. What was written until then is left behind.
        OSError, MemoryError: This machine has no room, or no file to give: no fault of the build's.
    """
    if not archive:
        raise BadArtefacts("what the build made could not be packed")
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
        raise BadArtefacts(f"what the build made cannot be read: {error}") from error


def check_room(size: int, most: int, number: int = 0) -> None:
    """Look at the size of what a build made.

    Args:
        size: Bytes that its files and folders take.
        most: Bytes that they may take.
        number: Files and folders.

    Raises:
        BadArtefacts: It is too much.
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
        raise BadArtefacts(f"{name[:80]!r} is no path inside the install folder")
    return parts


def _target(member: tarfile.TarInfo) -> PurePosixPath:
    """The target of a link. Read as text, which is exact: nothing in the folder is a link."""
    inside = os.path.normpath(PurePosixPath(*_parts(member.name)).parent / member.linkname)
    if inside.startswith(("..", "/")) or "\0" in inside:
        raise BadArtefacts(f"{member.name!r} leads out of the install folder")
    return PurePosixPath(inside)


def _copy(link: PurePosixPath, links: Mapping[PurePosixPath, PurePosixPath], folder: Path) -> int:
    """Put the file that a link names, perhaps by way of other links, in the link's place; its size in bytes."""
    target = link
    for _ in range(MAX_LINKS):
        target = links.get(target, target)
    place, source = folder / link, folder / target
    if target in links or not source.is_file():
        raise BadArtefacts(f"{str(link)!r} is a link to no file of the build's")
    if os.path.lexists(place):
        raise BadArtefacts(f"{str(link)!r} is there twice")
    place.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(source, place)
    return place.stat().st_size
