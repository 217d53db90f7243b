"""A workspace's sources as data: collected where a student's code runs, checked and written where it does not.

What is collected is what the student's side says its files are. It may say anything, as it may write any files: only
their number, their size and their names have to be harmless.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from autograder.messages.workspaces import Source
from autograder.workspaces.sources.packages import NOT_SOURCES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

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
"""How the names of files end that a launch file may need beside it."""


class BadSources(ValueError):
    """Sources that cannot be taken. The message is for a student."""


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
        workspace: What :func:`autograder.workspaces.running.launching.workspace_of` finds for it.

    Returns:
        The file's path among the sources, and these.

    Raises:
        BadSources: There is too much.
    """
    file = file.resolve()
    if workspace is not None and file.is_relative_to(workspace.resolve()):
        inside = f"{workspace.resolve().name}/{file.relative_to(workspace.resolve()).as_posix()}"
        near = [] if "/src/" in inside else [source for source in [_file(file, inside)] if source]
        return inside, _bounded([*collect_workspace(workspace), *near])
    beside = sorted(other for other in file.parent.iterdir() if other.suffix in LAUNCH_COMPANIONS)
    sources = [source for other in beside if (source := _file(other, other.name)) is not None]
    return file.name, _bounded([*sources, *(collect_workspace(workspace) if workspace else [])])


def checked(sources: Iterable[Source]) -> list[Source]:
    """The sources, once nothing about them can do harm: names, number, sizes; none of them twice.

    Raises:
        BadSources: Something could.
    """
    taken: dict[str, Source] = {}
    for source in sources:
        _check_path(source.path)
        if source.path in taken:
            raise BadSources(f"{source.path} is there twice")
        taken[source.path] = source
    for path in taken:
        above = (str(parent) for parent in PurePosixPath(path).parents)
        if any(taken[name].data is not None for name in above if name in taken):
            raise BadSources(f"{path} lies in a file")
    return _bounded(list(taken.values()))


def write(sources: Iterable[Source], folder: Path) -> None:
    """Write checked sources into a new folder that nobody else can write to."""
    for source in sources:
        path = folder / source.path
        if source.data is None:
            path.mkdir(parents=True, exist_ok=True)
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(source.data)
        path.chmod(0o755 if source.executable else 0o644)


def _check_path(path: str) -> None:
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
    """What a workspace's folder holds that a build may need, beginning with the folder itself."""
    if not folder.is_dir():
        return
    yield Source(name)
    # A package in place of a workspace is a mistake that has its own name: show that it is one.
    if (package := _file(folder / "package.xml", f"{name}/package.xml")) is not None:
        yield package
    src = folder / "src"
    for root, folders, files in os.walk(src, followlinks=False):
        folders[:] = sorted(f for f in folders if f not in NOT_SOURCES and not Path(root, f).is_symlink())
        inside = f"{name}/{Path(root).relative_to(folder).as_posix()}"
        yield Source(inside)
        for file in sorted(files):
            if (
                not file.endswith(".pyc")
                and (source := _file(Path(root, file), f"{inside}/{file}")) is not None
            ):
                yield source


def _file(file: Path, name: str) -> Source | None:
    """One regular file; None for what is none, so that no pipe or device is ever opened."""
    try:
        found = file.lstat()
        if not stat.S_ISREG(found.st_mode):
            return None
        if found.st_size > MAX_FILE:
            raise BadSources(
                f"{name} has more than {MAX_FILE // 1000} kB: a workspace for a check holds text"
            )
        return Source(name, file.read_bytes(), bool(found.st_mode & stat.S_IXUSR))
    except OSError:
        return None


def _bounded(sources: list[Source]) -> list[Source]:
    size = sum(len(source.data or b"") for source in sources)
    if len(sources) > MAX_FILES or size > MAX_BYTES or any(len(s.data or b"") > MAX_FILE for s in sources):
        raise BadSources(
            f"there is too much in src: at most {MAX_FILES} files, {MAX_FILE // 1000} kB each and "
            f"{MAX_BYTES // 10**6} MB together are taken for a check"
        )
    return sources
