"""Sources as one value, read once: both the hash in a build's key and the files of the build come from it.

So a build contains nothing that is not in its key. Files that are not sources (links, pipes, devices, files that
tools leave behind or compilers make, unreadable files) are in neither; nor are times, rights other than to execute,
and the order of a folder. Names are bytes: two that differ in case or in their Unicode normal form are two.

In a class they are collected in the process that runs a student's code, and checked and written in another one. The
student's process may send anything, as a student may write any files: only the number, sizes and names of files must
be harmless.
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
    from collections.abc import Iterable, Iterator

    from autograder.messages.lines import Lines

MAX_FILES = 1_000
"""The limit on files and folders of one submission."""
MAX_BYTES = 4_000_000
"""The limit on bytes of all files together."""
MAX_FILE = 500_000
"""The limit on one file in bytes; as text it still fits into one message."""
MAX_PATH = 300
"""The limit on a path in bytes, including slashes."""
MAX_NAME = 120
"""The limit on each part of a path in bytes."""
MAX_DEPTH = 16
"""The limit on parts of a path."""
MAX_HELD = MAX_BYTES + MAX_FILES * MAX_PATH
"""The limit on content bytes and path characters that are held while they are being received."""
LAUNCH_COMPANIONS = (".py", ".xml", ".yaml", ".yml", ".json", ".txt")
"""The name endings of files next to a launch file that it may need."""
_NOT_SOURCES = {"__pycache__", ".git", ".ipynb_checkpoints", ".pytest_cache", ".mypy_cache", ".ruff_cache"}
"""Folders that tools leave among sources."""
_MACHINE_CODE = (b"\x7fELF", b"!<arch>\n", b"!<thin>\n")
"""The first bytes of programs, libraries and object files, and of archives of these (elf(5), ar(5))."""


class BadSources(ValueError):
    """Sources that cannot be used. The message is for a student."""


@dataclass(frozen=True)
class Tree:
    """The files and folders of one or more packages.

    Attributes:
        sources: Each folder before its content; paths are relative to the workspace's ``src``.
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
        """Write the sources into a folder that no other process can write to, and that has none of them yet.

        Raises:
            FileExistsError: One of the files exists already.
        """
        for source in self.sources:
            path = folder / source.path
            (path if source.data is None else path.parent).mkdir(parents=True, exist_ok=True)
            if source.data is not None:
                with path.open("xb") as file:
                    file.write(source.data)
                path.chmod(0o755 if source.executable else 0o644)


def is_source(path: str) -> bool:
    """True if a path may be a source, judged by its names: compiled Python and folders of tools are not."""
    return not any(part in _NOT_SOURCES or part.endswith(".pyc") for part in path.split("/"))


def read(folder: Path, name: str, largest: int) -> Iterator[Source]:
    """Yield the sources in a folder and below it, beginning with the folder; none if it is not a folder.

    Args:
        folder: The folder; its own path may contain links, but links below it are not followed.
        name: The name of the folder among the sources.
        largest: The limit on a file in bytes.

    Raises:
        BadSources: A file is larger.
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
    """Read one regular file; return None for anything else, or if it is unreadable.

    Args:
        file: The path.
        name: The name of the file among the sources.
        largest: The limit in bytes.
        folder: The descriptor of the folder to which the path is relative.

    Raises:
        BadSources: The file is larger.
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
        raise BadSources(f"{name} has more than {largest // 1000} kB: a workspace for a check holds text")
    return Source(name, data, executable)


def collect_workspace(workspace: Path) -> list[Source]:
    """Return everything in ``src`` of a workspace, under the workspace's name; links and special files are left out.

    A path that is not a folder yields nothing; a later step reports that.

    Raises:
        BadSources: The workspace is too large.
    """
    if not workspace.is_dir():
        return []
    name = workspace.resolve().name
    # A package given instead of a workspace is a mistake with its own diagnosis: include its package.xml.
    package = read_file(workspace / "package.xml", f"{name}/package.xml", MAX_FILE)
    sources = read(workspace / "src", f"{name}/src", MAX_FILE)
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
        near = [] if "/src/" in inside else [read_file(file, inside, MAX_FILE)]
        return inside, _bounded([*collect_workspace(workspace), *filter(None, near)])
    beside = sorted(other for other in file.parent.iterdir() if other.suffix in LAUNCH_COMPANIONS)
    sources = filter(None, (read_file(other, other.name, MAX_FILE) for other in beside))
    return file.name, _bounded([*sources, *(collect_workspace(workspace) if workspace else [])])


def checked(sources: Iterable[Source]) -> list[Source]:
    """Return the sources after checking that they are harmless: names, number, sizes, no duplicates.

    Files that are not sources are dropped here again, so that a box sees nothing that is not in the key.

    Raises:
        BadSources: They could do harm.
    """
    taken: dict[str, Source] = {}
    for source in sources:
        check_path(source.path)
        if source.path in taken:
            raise BadSources(f"{source.path} is there twice")
        taken[source.path] = source
    for path in taken:
        above = (str(parent) for parent in PurePosixPath(path).parents)
        if any(taken[name].data is not None for name in above if name in taken):
            raise BadSources(f"{path} lies in a file")
    return [source for source in _bounded(list(taken.values())) if _is_source(source)]


def _is_source(source: Source) -> bool:
    return is_source(source.path) and not (source.data or b"").startswith(_MACHINE_CODE)


def room_of(source: Source) -> int:
    """Return how much of :data:`MAX_HELD` a source takes."""
    return len(source.data or b"") + len(source.path)


def receive(lines: Lines, count: int, path: str, folder: Path) -> None:
    """Write sources from another process into a folder, after checking that they are harmless.

    Args:
        lines: The connection to that process.
        count: The number of sources, as the sender claims.
        path: The path of the workspace or launch file among them, as the sender claims.
        folder: An empty folder for this call alone.

    Raises:
        BadSources: The sources could do harm.
        NotUnderstood: Another message came.
        Hangup: The connection was closed.
    """
    if not 0 <= count <= MAX_FILES:
        raise BadSources("there is too much in src")
    taken: list[Source] = []
    room = MAX_HELD
    for _ in range(count):
        source = lines.hear(Source)
        room -= room_of(source)
        if room >= 0:  # otherwise the source is read, because more messages may follow, but dropped
            taken.append(source)
    if room < 0:
        raise _too_much()
    check_path(path)
    Tree(tuple(checked(taken))).write(folder)


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
        raise BadSources(f"{shown} is no path inside a workspace")
    if not path.isprintable():
        raise BadSources(f"the path {shown} has characters that cannot be shown")


def _bounded(sources: list[Source]) -> list[Source]:
    size = sum(len(source.data or b"") for source in sources)
    if len(sources) > MAX_FILES or size > MAX_BYTES or any(len(s.data or b"") > MAX_FILE for s in sources):
        raise _too_much()
    return sources


def _too_much() -> BadSources:
    return BadSources(
        f"there is too much in src: at most {MAX_FILES} files, {MAX_FILE // 1000} kB each and "
        f"{MAX_BYTES // 10**6} MB together are taken for a check"
    )
