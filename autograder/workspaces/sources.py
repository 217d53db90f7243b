"""Sources as one value, read once: a build is known by their hash, and what is built is written from them.

So nothing can be in a build that is not in its key. What is no source (links, pipes, devices, what tools leave behind,
what a compiler has made, what may not be read) is in neither; nor are times, other rights than to execute, and the
order of a folder. Names are bytes: two that differ in case or in their Unicode normal form are two.

In a class they are collected where a student's code runs, and checked and written where it does not. The student's side
may say anything, as it may write any files: only their number, their size and their names have to be harmless.
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
"""Files and folders that one submission may send."""
MAX_BYTES = 4_000_000
"""Bytes of all files together."""
MAX_FILE = 500_000
"""Bytes of one file; as text it still fits into one message."""
MAX_PATH = 300
"""Bytes of a path, its slashes included."""
MAX_NAME = 120
"""Bytes of each part of a path."""
MAX_DEPTH = 16
"""Parts of a path."""
MAX_HELD = MAX_BYTES + MAX_FILES * MAX_PATH
"""Bytes of content and characters of paths that are held while somebody still sends."""
LAUNCH_COMPANIONS = (".py", ".xml", ".yaml", ".yml", ".json", ".txt")
"""The endings of the names of files that a launch file may need beside it."""
_NOT_SOURCES = {"__pycache__", ".git", ".ipynb_checkpoints", ".pytest_cache", ".mypy_cache", ".ruff_cache"}
"""Folders that tools leave among sources."""
_MACHINE_CODE = (b"\x7fELF", b"!<arch>\n", b"!<thin>\n")
"""The first bytes of programs, libraries and object files, and of archives of these (elf(5), ar(5))."""


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
    if data.startswith(_MACHINE_CODE):
        return None
    if len(data) > largest:
        raise BadSources(f"{name} has more than {largest // 1000} kB: a workspace for a check holds text")
    return Source(name, data, executable)


def collect_workspace(workspace: Path) -> list[Source]:
    """Everything in ``src`` of a workspace, under the workspace's name; links and special files are left out.

    Nothing comes of a folder that is none: who looks at that says so.

    Raises:
        BadSources: There is too much.
    """
    if not workspace.is_dir():
        return []
    name = workspace.resolve().name
    # A package in place of a workspace is a mistake that has its own name: show that it is one.
    package = read_file(workspace / "package.xml", f"{name}/package.xml", MAX_FILE)
    sources = read(workspace / "src", f"{name}/src", MAX_FILE)
    return _bounded([Source(name), *([package] if package else []), *sources])


def collect_launch(file: Path, workspace: Path | None) -> tuple[str, list[Source]]:
    """A launch file, the small text files beside it, and the workspace around or beside it.

    Args:
        file: The launch file.
        workspace: What :func:`autograder.workspaces.packages.workspace_of` finds for it.

    Returns:
        The file's path among the sources, and these.

    Raises:
        BadSources: There is too much.
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
    """The sources, once nothing about them can do harm: names, number, sizes; none of them twice.

    What is no source is left out here once more: no box is to see what no key has in it.

    Raises:
        BadSources: Something could.
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
    """How much of :data:`MAX_HELD` a source takes."""
    return len(source.data or b"") + len(source.path)


def receive(lines: Lines, count: int, path: str, folder: Path) -> None:
    """Write down sources that somebody else sends, once nothing about them can do harm.

    Args:
        lines: Their end.
        count: How many they say that there are.
        path: What they call the workspace or the launch file among them.
        folder: Empty, ours alone.

    Raises:
        BadSources: Something could.
        NotUnderstood: They send something else.
        Hangup: They are gone.
    """
    if not 0 <= count <= MAX_FILES:
        raise BadSources("there is too much in src")
    taken: list[Source] = []
    room = MAX_HELD
    for _ in range(count):
        source = lines.hear(Source)
        room -= room_of(source)
        if room >= 0:  # else it is heard, since more may be said behind it, and not kept
            taken.append(source)
    if room < 0:
        raise _too_much()
    check_path(path)
    Tree(tuple(checked(taken))).write(folder)


def check_path(path: str) -> None:
    """Look at a path that somebody else has named.

    Raises:
        BadSources: It leads out of a workspace, or is too long or too strange to be shown.
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
