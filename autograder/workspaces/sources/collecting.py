"""A workspace's sources as data: collected where a student's code runs, checked and written where it does not.

What is collected is what the student's side says its files are. It may say anything, as it may write any files: only
their number, their size and their names have to be harmless.
"""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from autograder.messages.workspaces import Source
from autograder.workspaces.sources.tree import BadSources, Tree, is_source, read, read_file

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
LAUNCH_COMPANIONS = (".py", ".xml", ".yaml", ".yml", ".json", ".txt")
"""The endings of the names of files that a launch file may need beside it."""


def collect_workspace(workspace: Path) -> list[Source]:
    """Everything in ``src`` of a workspace, under the workspace's name; links and special files are left out.

    Nothing comes of a folder that is none: who looks at that says so.

    Raises:
        BadSources: There is too much.
    """
    sources = list(_tree(workspace, workspace.resolve().name))
    return _bounded(sources)


def collect_launch(file: Path, workspace: Path | None) -> tuple[str, list[Source]]:
    """A launch file, the small text files beside it, and the workspace around or beside it.

    Args:
        file: The launch file.
        workspace: What :func:`autograder.workspaces.sources.finding.workspace_of` finds for it.

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

    What is no source by its name is left out here once more: no box is to see what no key has in it.

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
    return [source for source in _bounded(list(taken.values())) if is_source(source.path)]


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
    taken = [lines.hear(Source) for _ in range(count)]
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


def _tree(folder: Path, name: str) -> Iterator[Source]:
    """The files of a workspace's folder that a build may need, beginning with the folder itself."""
    if not folder.is_dir():
        return
    yield Source(name)
    # A package in place of a workspace is a mistake that has its own name: show that it is one.
    if (package := read_file(folder / "package.xml", f"{name}/package.xml", MAX_FILE)) is not None:
        yield package
    yield from read(folder / "src", f"{name}/src", MAX_FILE)


def _bounded(sources: list[Source]) -> list[Source]:
    size = sum(len(source.data or b"") for source in sources)
    if len(sources) > MAX_FILES or size > MAX_BYTES or any(len(s.data or b"") > MAX_FILE for s in sources):
        raise BadSources(
            f"there is too much in src: at most {MAX_FILES} files, {MAX_FILE // 1000} kB each and "
            f"{MAX_BYTES // 10**6} MB together are taken for a check"
        )
    return sources
