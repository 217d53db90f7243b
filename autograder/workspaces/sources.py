"""Reads the sources of a build once into memory, for both the build's key and the files that are built.

In this way a build depends on nothing that its key does not cover. Links, pipes, devices, unreadable files, and files
that tools or compilers make are not sources. Times, the order of files in a folder, and permissions (except the one to
execute) are not read, either. Names are bytes, so two names that differ in case or in their Unicode normal form are
different.

When a class is graded, the sources are collected in the process that runs a student's code, and checked and written in
another process. The student's process may send anything, so the number, sizes and names of the files are checked. The
content of a file need not be checked.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import stat
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from autograder.messages.workspace_messages import Source
from autograder.safe_files import opened

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from autograder.messages.json_lines import Lines


MAX_FILES = 1_000
"""The maximum number of files and folders in one submission."""
MAX_BYTES = 4_000_000
"""The maximum size in bytes of all files together."""
MAX_FILE = 500_000
"""The maximum size of a file in bytes. The content of a file of this size, encoded as text, fits into one message."""
MAX_PATH = 300
"""The maximum length of a path in bytes, including slashes."""
MAX_NAME = 120
"""The maximum length of each part of a path, in bytes."""
MAX_DEPTH = 16
"""The maximum number of parts of a path."""
MAX_HELD = MAX_BYTES + MAX_FILES * MAX_PATH
"""The maximum size of the sources that are kept in memory while sources are received: bytes of contents plus characters
of paths.
"""
LAUNCH_COMPANIONS = (".py", ".xml", ".yaml", ".yml", ".json", ".txt")
"""The extensions of files next to a launch file that the launch file may need."""
_NOT_SOURCES = {"__pycache__", ".git", ".ipynb_checkpoints", ".pytest_cache", ".mypy_cache", ".ruff_cache"}
"""Folders that tools leave among the sources."""
_MACHINE_CODE = (b"\x7fELF", b"!<arch>\n", b"!<thin>\n")
"""The first bytes of compiled files: programs, libraries, object files and archives of these (elf(5), ar(5))."""


class BadSources(ValueError):
    """The sources cannot be used. The exception's text says why, in words for a student."""


@dataclass(frozen=True)
class SourceTree:
    """The files and folders of one or more packages.

    Attributes:
        sources: The files and folders; each folder comes before its content. Paths are relative to the workspace's
            ``src``.
    """

    sources: tuple[Source, ...]

    @property
    def digest(self) -> str:
        """The SHA-256 hash of everything that :meth:`write` writes."""
        digest = hashlib.sha256()
        for source in self.sources:
            kind = b"folder" if source.data is None else b"program" if source.executable else b"file"
            name, data = os.fsencode(source.path), source.data or b""
            digest.update(b"%s %d %d\0" % (kind, len(name), len(data)) + name + data)
        return digest.hexdigest()

    def write(self, folder: Path) -> None:
        """Write the sources into a folder, to which no other process may write.

        Raises:
            FileExistsError: One of the files already exists.
        """
        for source in self.sources:
            path = folder / source.path
            (path if source.data is None else path.parent).mkdir(parents=True, exist_ok=True)
            if source.data is not None:
                with path.open("xb") as file:
                    file.write(source.data)
                path.chmod(0o755 if source.executable else 0o644)


def collect_workspace(workspace: Path) -> list[Source]:
    """Return all sources in ``src`` of a workspace. Their paths begin with the name of the workspace.

    If the path is not a folder, return no sources, because a later step reports that.

    Raises:
        BadSources: The workspace is too large.
    """
    if not workspace.is_dir():
        return []
    name = workspace.resolve().name
    # Include a package.xml: if the path is a package instead of a workspace, a diagnosis reports this from the file.
    package = _read_file(workspace / "package.xml", f"{name}/package.xml", MAX_FILE)
    sources = read_sources(workspace / "src", f"{name}/src", MAX_FILE)
    return _bounded([Source(name), *([package] if package else []), *sources])


def collect_launch(file: Path, workspace: Path | None) -> tuple[str, list[Source]]:
    """Return a launch file, the small text files next to it, and the workspace around or next to it.

    Args:
        file: The launch file.
        workspace: The result of :func:`autograder.workspaces.packages.workspace_of`.

    Returns:
        The file's path among the sources, and the sources.

    Raises:
        BadSources: The sources are too large.
    """
    file = file.resolve()
    if workspace is not None and file.is_relative_to(workspace.resolve()):
        inside = f"{workspace.resolve().name}/{file.relative_to(workspace.resolve()).as_posix()}"
        near = [] if "/src/" in inside else [_read_file(file, inside, MAX_FILE)]
        return inside, _bounded([*collect_workspace(workspace), *filter(None, near)])
    beside = sorted(other for other in file.parent.iterdir() if other.suffix in LAUNCH_COMPANIONS)
    sources = filter(None, (_read_file(other, other.name, MAX_FILE) for other in beside))
    return file.name, _bounded([*sources, *(collect_workspace(workspace) if workspace else [])])


ROOM = 1_000_000
"""Free bytes of a disk below which it counts as full, because no workspace can be built."""


def full_disk(path: str | os.PathLike[str]) -> str:
    """Return why nothing on the disk of a workspace or launch file can be checked; empty if there is room on it.

    On a full disk, programs leave empty files behind, which look like mistakes of the student.
    """
    if not os.path.exists(path) or shutil.disk_usage(path).free >= ROOM:  # noqa: PTH110  (a path may be a text)
        return ""
    return (
        f"The disk with {os.fspath(path)} is full, so files that you have just written may be empty.\n"
        "Delete what you do not need, write these files again, and repeat the check."
    )


def read_sources(folder: Path, name: str, largest: int) -> Iterator[Source]:
    """Yield a folder and the sources below it, the folder first; nothing if it is not a folder.

    Args:
        folder: The path of the folder. It may contain links, but links below the folder are not followed.
        name: The folder's name in the paths of the sources.
        largest: The maximum size of a file in bytes.

    Raises:
        BadSources: A file is larger than ``largest``.
    """
    folder = folder.resolve()
    if not folder.is_dir():
        return
    for root, folders, files, descriptor in os.fwalk(folder):
        folders[:] = sorted(filter(is_source, folders))
        inside = PurePosixPath(name) / Path(root).relative_to(folder)
        yield Source(inside.as_posix())
        for file in sorted(filter(is_source, files)):
            if (source := _read_file(file, (inside / file).as_posix(), largest, descriptor)) is not None:
                yield source


def _read_file(file: str | Path, name: str, largest: int, folder: int | None = None) -> Source | None:
    """Read a source file. Return None if it is unreadable, compiled, or not a regular file.

    Args:
        name: The file's path among the sources.
        largest: The maximum size in bytes.
        folder: The descriptor of the folder to which the path is relative.

    Raises:
        BadSources: The file is larger than ``largest``.
    """
    try:
        with opened(file, folder) as stream:
            executable = bool(os.fstat(stream.fileno()).st_mode & stat.S_IXUSR)
            data = stream.read(largest + 1)
    except OSError:
        return None
    if data.startswith(_MACHINE_CODE):
        return None
    if len(data) > largest:
        raise BadSources(
            f"{name} is larger than {largest // 1000} kB, the limit for a file in a check: move it out of the workspace"
        )
    return Source(name, data, executable)


def is_source(path: str) -> bool:
    """Return True if a file with this path may be a source: it is not a .pyc file, nor in a folder that tools make."""
    return not any(part in _NOT_SOURCES or part.endswith(".pyc") for part in path.split("/"))


def receive_sources(lines: Lines, count: int, path: str, folder: Path) -> None:
    """Receive sources from another process, check that they are harmless, and write them into a folder.

    Args:
        lines: The connection to that process.
        count: The number of sources that the sender announced.
        path: The path of the workspace or launch file among the sources, as the sender announced it.
        folder: An empty folder that nothing else uses.

    Raises:
        BadSources: The sources could do harm.
        NotUnderstood: A message is not a source.
        Hangup: The connection was closed.
    """
    if not 0 <= count <= MAX_FILES:
        raise BadSources(f"src has too many files: a check accepts at most {MAX_FILES}")
    taken: list[Source] = []
    room = MAX_HELD
    for _ in range(count):
        source = lines.hear(Source)
        room -= room_of(source)
        # Read the sources beyond the limit as well, but do not keep them: other messages may follow on this connection.
        if room >= 0:
            taken.append(source)
    if room < 0:
        raise _too_much()
    check_path(path)
    SourceTree(tuple(checked_sources(taken))).write(folder)


def room_of(source: Source) -> int:
    """Return how much of the limit :data:`MAX_HELD` a source uses."""
    return len(source.data or b"") + len(source.path)


def checked_sources(sources: Iterable[Source]) -> list[Source]:
    """Check that sources are harmless (names, number, sizes, no duplicates), and return the real sources among them.

    Other files are dropped, so that a box sees nothing that the build's key does not cover. An honest sender has
    already left them out.

    Raises:
        BadSources: The sources could do harm.
    """
    taken: dict[str, Source] = {}
    for source in sources:
        check_path(source.path)
        if source.path in taken:
            raise BadSources(f"{source.path} was sent twice")
        taken[source.path] = source
    for path in taken:
        above = (str(parent) for parent in PurePosixPath(path).parents)
        if any(taken[name].data is not None for name in above if name in taken):
            raise BadSources(f"{path} cannot be written, because one of its parent folders is a file")
    return [
        source
        for source in _bounded(list(taken.values()))
        if is_source(source.path) and not (source.data or b"").startswith(_MACHINE_CODE)
    ]


def check_path(path: str) -> None:
    """Check a path that another process has sent.

    Raises:
        BadSources: The path leads out of a workspace, or is too long or too strange to be shown.
    """
    parts = path.split("/")
    shown = repr(path[:80])
    encoded = path.encode("utf-8", "surrogatepass")
    if len(encoded) > MAX_PATH or len(parts) > MAX_DEPTH:
        raise BadSources(f"the path {shown} is too long")
    if any(
        part in ("", ".", "..") or len(part.encode("utf-8", "surrogatepass")) > MAX_NAME for part in parts
    ):
        raise BadSources(f"{shown} is not a path inside a workspace")
    if not path.isprintable():
        raise BadSources(f"the path {shown} has characters that cannot be shown")


def _bounded(sources: list[Source]) -> list[Source]:
    size = sum(len(source.data or b"") for source in sources)
    if len(sources) > MAX_FILES or size > MAX_BYTES or any(len(s.data or b"") > MAX_FILE for s in sources):
        raise _too_much()
    return sources


def _too_much() -> BadSources:
    return BadSources(
        f"src is too large: a check accepts at most {MAX_FILES} files, {MAX_FILE // 1000} kB for each file, and "
        f"{MAX_BYTES // 10**6} MB for all files together"
    )


class ByteBudget:
    """The number of bytes that may still be read from a set of files: each may be small, but all together too large.

    Args:
        size: The maximum number of bytes for all files together.

    Attributes:
        sufficed: True if the budget was enough for every file so far.
    """

    def __init__(self, size: int) -> None:
        self._left = size
        self.sufficed = True

    def has(self, file: Path) -> bool:
        """Subtract a file's size from the bytes that are left; if fewer are left, return False and subtract nothing.

        A missing file has the size 0.
        """
        try:
            size = file.stat().st_size
        except OSError:
            size = 0
        if size > self._left:
            self.sufficed = False
            return False
        self._left -= size
        return True
