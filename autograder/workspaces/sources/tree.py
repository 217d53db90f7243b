"""Sources as one value, read once: a build is known by its hash, and what is built is written from it.

So nothing can be in a build that is not in its key. What is no source (links, pipes, devices, what tools leave behind,
what may not be read) is in neither; nor are times, other rights than to execute, and the order of a folder. Names are
bytes: two that differ in case or in their Unicode normal form are two.
"""

from __future__ import annotations

import hashlib
import os
import stat
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from autograder.messages.workspaces import Source
from autograder.regular_files import opened

if TYPE_CHECKING:
    from collections.abc import Iterator

_NOT_SOURCES = {"__pycache__", ".git", ".ipynb_checkpoints", ".pytest_cache", ".mypy_cache", ".ruff_cache"}
"""Folders that tools leave among sources."""


class BadSources(ValueError):
    """Sources that cannot be taken. The message is for a student."""


@dataclass(frozen=True)
class Tree:
    """Files and folders of one or more packages.

    Attributes:
        sources: Each folder before what is in it; paths are relative to the workspace's ``src``.
    """

    sources: tuple[Source, ...]

    @property
    def digest(self) -> str:
        """The SHA-256 of everything that :meth:`write` writes."""
        digest = hashlib.sha256()
        for source in self.sources:
            kind = b"folder" if source.data is None else b"program" if source.executable else b"file"
            name, data = os.fsencode(source.path), source.data or b""
            digest.update(b"%s %d %d\0" % (kind, len(name), len(data)) + name + data)
        return digest.hexdigest()

    def write(self, folder: Path) -> None:
        """Write it into a folder that nobody else can write to, and in which nothing of it is yet.

        Raises:
            FileExistsError: A file of it is there already.
        """
        for source in self.sources:
            path = folder / source.path
            (path if source.data is None else path.parent).mkdir(parents=True, exist_ok=True)
            if source.data is not None:
                with path.open("xb") as file:
                    file.write(source.data)
                path.chmod(0o755 if source.executable else 0o644)


def is_source(path: str) -> bool:
    """True if a path is a source's, by its names alone: compiled Python and folders of tools are none."""
    return not any(part in _NOT_SOURCES or part.endswith(".pyc") for part in path.split("/"))


def read(folder: Path, name: str, largest: int) -> Iterator[Source]:
    """The sources in a folder and below, beginning with the folder itself; none where it is no folder.

    Args:
        folder: The folder; it may be named through links, and none below it is followed.
        name: What it is called among the sources.
        largest: Bytes that a file may have.

    Raises:
        BadSources: A file has more.
    """
    folder = folder.resolve()
    if not folder.is_dir():
        return
    for root, folders, files, descriptor in os.fwalk(folder):
        folders[:] = sorted(filter(is_source, folders))
        inside = PurePosixPath(name) / Path(root).relative_to(folder)
        yield Source(inside.as_posix())
        for file in sorted(filter(is_source, files)):
            if (source := read_file(file, (inside / file).as_posix(), largest, descriptor)) is not None:
                yield source


def read_file(file: str | Path, name: str, largest: int, folder: int | None = None) -> Source | None:
    """One regular file that may be read; None for anything else.

    Args:
        file: Where it is.
        name: What it is called among the sources.
        largest: Bytes that it may have.
        folder: A descriptor of the folder that the place is relative to.

    Raises:
        BadSources: It has more.
    """
    try:
        with opened(file, folder) as stream:
            executable = bool(os.fstat(stream.fileno()).st_mode & stat.S_IXUSR)
            data = stream.read(largest + 1)
    except OSError:
        return None
    if len(data) > largest:
        raise BadSources(f"{name} has more than {largest // 1000} kB: a workspace for a check holds text")
    return Source(name, data, executable)
