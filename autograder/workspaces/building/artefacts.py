"""What a build has made, taken over as data: regular files, folders, and links that stay inside."""

from __future__ import annotations

import io
import os
import tarfile
from pathlib import Path, PurePosixPath

MAX_FILES = 5_000
MAX_BYTES = 64_000_000
MAX_NAME = 240
"""Bytes of each part of a path."""


class BadArtefacts(ValueError):
    """An archive that is none, or that holds what no build of a workspace makes."""


def unpack(archive: bytes, folder: Path) -> None:
    """Write an archive of a build's install folder.

    Args:
        archive: A tar file that may be anything: whoever was built could have written it.
        folder: A folder that is not there yet.

    Raises:
        BadArtefacts: It has entries that lead out of the folder, devices, or too much of anything. What was
            written until then is left behind.
    """
    folder.mkdir(mode=0o755)
    number = size = 0
    try:
        with tarfile.open(fileobj=io.BytesIO(archive), mode="r:") as tar:
            for member in tar:
                number += 1
                size += max(member.size, 0)
                if number > MAX_FILES or size > MAX_BYTES:
                    raise BadArtefacts("the build made more than a workspace has")
                _take(tar, member, folder)
    except (tarfile.TarError, OSError, ValueError, RecursionError, MemoryError, OverflowError) as error:
        if isinstance(error, BadArtefacts):
            raise
        raise BadArtefacts(f"what the build made cannot be read: {error}") from error


def _take(tar: tarfile.TarFile, member: tarfile.TarInfo, folder: Path) -> None:
    place = folder.joinpath(*_parts(member.name))
    if member.isdir():
        place.mkdir(parents=True, exist_ok=True)
        return
    # Each folder comes before what is in it. One that is a link by now would lead somewhere else.
    if any(parent.is_symlink() for parent in _between(place, folder)) or os.path.lexists(place):
        raise BadArtefacts(f"{member.name!r} is there twice or lies behind a link")
    place.parent.mkdir(parents=True, exist_ok=True)
    if member.issym():
        _check_link(member)
        place.symlink_to(member.linkname)
    elif member.type in (tarfile.REGTYPE, tarfile.AREGTYPE):
        source = tar.extractfile(member)
        assert source is not None
        place.write_bytes(source.read())
        place.chmod(0o755 if member.mode & 0o100 else 0o644)
    else:
        raise BadArtefacts(f"{member.name!r} is neither a file nor a folder")


def _between(place: Path, folder: Path) -> list[Path]:
    return [parent for parent in place.parents if parent != folder and parent.is_relative_to(folder)]


def _parts(name: str) -> tuple[str, ...]:
    path = PurePosixPath(name)
    parts = path.parts
    if (
        path.is_absolute()
        or "\0" in name
        or ".." in parts
        or any(len(os.fsencode(p)) > MAX_NAME for p in parts)
    ):
        raise BadArtefacts(f"{name[:80]!r} is no path inside the install folder")
    return parts


def _check_link(member: tarfile.TarInfo) -> None:
    target = PurePosixPath(member.linkname)
    inside = os.path.normpath(PurePosixPath(member.name).parent / target)
    if target.is_absolute() or inside.startswith("..") or "\0" in member.linkname:
        raise BadArtefacts(f"{member.name!r} leads out of the install folder")


def rename_paths(folder: Path, old: str, new: str) -> None:
    """Replace one path by another in the text files of a folder (setup scripts, what CMake and setuptools wrote)."""
    for root, _, names in os.walk(folder):
        for file in (Path(root, name) for name in names):
            content = b"" if file.is_symlink() else file.read_bytes()
            if old.encode() in content and b"\0" not in content:
                file.write_bytes(content.replace(old.encode(), new.encode()))
