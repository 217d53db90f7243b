"""Builds a student's own workspace, in a notebook or a terminal on the student's own computer.

A check always builds the sources (`src`), because students hand in only sources, and the grader of a class builds
these. The student's own build (`install`) is not used. But if sources were changed since the last `colcon build`, the
card names them, because `ros2 run` in a terminal still runs the old program. This is decided by comparing two times:
when a file's content or name last changed (``st_ctime``), and when the package's last `colcon build` began. The times
can be compared because both come from the same file system, and so from the same clock; and no program can set
``st_ctime``. Comparing contents instead would not be enough, because `install` has no copy of setup.py or
CMakeLists.txt. But a newer file that equals its installed copy counts as unchanged. For example, running a cell that
writes a program changes the file's time even if the program stays the same.

In a graded notebook, the command ``colcon build`` in a cell requests its builds from the grader. The notebook's box
cannot see the grader's folders, so it receives each build as an archive. There, this module is the program `colcon`:
the grader makes plain builds, and the real colcon does everything else. A plain build is ``colcon build`` in a
workspace, with at most the options ``--packages-select`` or ``--packages-up-to``. As usual, it leaves the packages in
``install`` and lists the finished packages. But it leaves ``log`` empty, and does not leave the files in ``build`` that
would make colcon's next build faster.
"""

from __future__ import annotations

import contextlib
import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.messages import workspace_messages as messages
from autograder.messages.json_lines import Hangup, Lines, NotUnderstood
from autograder.workspaces.builds import build_artifacts, build_cache
from autograder.workspaces.builds.cached_builds import Builds, BuildTookTooLong
from autograder.workspaces.builds.colcon_build import (
    CannotCopyBuild,
    copy_to_workspace,
    describe_workspace,
    packages_to_build,
)
from autograder.workspaces.builds.install_folder import BESIDE, linked_build, rename_paths
from autograder.workspaces.jobs import PlainJobs
from autograder.workspaces.packages import WORKSPACE, needed
from autograder.workspaces.sources import BadSources, collect_workspace, is_source
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from autograder.workspaces.builds.colcon_build import Build, Targets
    from autograder.workspaces.jobs import BuildJob
    from autograder.workspaces.packages import Package


GRADERS = "AUTOGRADER_BUILDS"
"""The environment variable that, in a graded notebook, contains the path of the grader's socket."""
LIMIT = 300.0
"""Time limit in seconds of wall time for the grader to make a build."""


class StudentsBuilds(Builds):
    """Makes builds in the cache or, in a graded notebook, requests them from the grader.

    A build does not write to the workspace, and does not use earlier results in its ``install`` folder.
    """

    def __init__(self) -> None:
        super().__init__(build_cache.root(), PlainJobs(os.environ, handed_in=False))

    def build(
        self,
        found: Build,
        targets: Targets | None,
        *,
        name: str = WORKSPACE,
        cancelled: Callable[[], bool] = lambda: False,
    ) -> Build:
        """Build the needed packages, and name the sources that were changed since the student's last build.

        A build that took too long is returned like a failed one.
        """
        try:
            made = super().build(found, targets, name=name, cancelled=cancelled)
        except BuildTookTooLong as error:
            made = error.build
        if name != WORKSPACE:
            return made
        chosen, _ = packages_to_build(found, targets)
        return replace(made, changed=changed_since(found.workspace, chosen))

    def _make(self, found: Build, job: BuildJob, entry: build_cache.CachedBuild) -> Build:
        socket = os.environ.get(GRADERS)
        asked = _ask(socket, found, job.packages, entry.folder / "install") if socket else None
        return asked or super()._make(found, job, entry)


def _ask(socket: str, found: Build, chosen: Iterable[Package], install: Path) -> Build | None:
    """Request a build of packages from the grader.

    Args:
        socket: The path of the grader's socket.
        found: The workspace, as :func:`autograder.workspaces.builds.colcon_build.describe_workspace` returns it.
        install: The folder to create for the build. It must not exist yet.

    Returns:
        The build, with paths that fit its new install folder; None if the grader does not answer, or refuses.
    """
    try:
        collected = collect_workspace(found.workspace)
        lines = Lines.to(socket, LIMIT)
    except (BadSources, Hangup):
        return None
    with contextlib.closing(lines), contextlib.suppress(Hangup, NotUnderstood, build_artifacts.BadArtifacts):
        top = found.workspace.resolve().name
        lines.say(messages.BuildRequest(len(collected), top, [package.name for package in chosen]))
        for source in collected:
            lines.say(source)
        answer: messages.BuildAnswer = lines.hear(messages.BuildAnswer)
        if isinstance(answer, messages.BuildFailed):
            return replace(
                found,
                seconds=answer.seconds,
                trouble=answer.trouble,
                package=answer.package,
                line=answer.line,
                log=answer.log,
            )
        if isinstance(answer, messages.BuildDone):
            archive = b"".join(lines.hear(messages.Piece).data for _ in range(answer.pieces))
            build_artifacts.unpack(archive, install)
            # The grader built in another folder, and the installed files contain its path.
            rename_paths(install, answer.install, str(install))
            return replace(found, ok=True, install=install, seconds=answer.seconds)
    return None


_MOST_NAMED = 3
"""The maximum number of changed files to name."""
_BEGAN = "colcon_command_prefix_*.sh"
"""A file that colcon writes into a package's build folder when it begins to build the package."""


def changed_since(workspace: Path, packages: Iterable[Package]) -> str:
    """Return the names of the sources that were changed since the last `colcon build`; empty if there are none.

    A package that was never built has no changed sources.
    """
    names = [
        f"`{file.relative_to(package.folder.parent)}`"
        for package in packages
        for file in _changed(workspace, package)
    ]
    more = [f"{len(names) - _MOST_NAMED} more"] if len(names) > _MOST_NAMED else []
    *others, last = [*names[:_MOST_NAMED], *more] or [""]
    return f"{', '.join(others)} and {last}" if others else last


def _changed(workspace: Path, package: Package) -> Iterator[Path]:
    """Yield the sources of a package that were changed since its last build began."""
    build, prefix = (workspace / folder / package.name for folder in ("build", "install"))
    began = max((file.stat().st_mtime_ns for file in build.glob(_BEGAN)), default=None)
    if began is None or not prefix.is_dir():
        return
    linked = _linked(prefix)
    for file in _sources(package):
        if file.stat().st_ctime_ns < began or any(file.is_relative_to(folder) for folder in linked):
            continue
        if not any(_is_copy(copy, file, package.folder) for copy in prefix.rglob("*")):
            yield file


def _linked(prefix: Path) -> list[Path]:
    """Return the source folders to which `--symlink-install` made links, and from which Python imports the modules."""
    build = linked_build(prefix)
    return (
        [entry.resolve() for entry in build.iterdir() if entry.is_symlink() and entry.is_dir()]
        if build
        else []
    )


def _sources(package: Package) -> Iterator[Path]:
    """Yield the files of a package that a grader would build; links are left out."""
    for file in sorted(package.folder.rglob("*")):
        if (
            is_source(file.relative_to(package.folder).as_posix())
            and file.is_file()
            and not file.is_symlink()
        ):
            yield file


def _is_copy(copy: Path, file: Path, folder: Path) -> bool:
    """Return True if ``copy`` has the bytes of ``file``, and its path ends with the path of ``file`` in ``folder``."""
    inside = file.relative_to(folder).parts
    return copy.parts[-len(inside) :] == inside and copy.is_file() and copy.read_bytes() == file.read_bytes()


def main(arguments: Sequence[str]) -> int:
    """Request a plain build from the grader, or replace this process by the real colcon. Return the exit code."""
    chosen = _chosen(arguments)
    found = describe_workspace(Path.cwd())
    if os.environ.get(GRADERS) and chosen is not None and not found.trouble and not found.unusable:
        option, names = chosen
        if set(names) <= {package.name for package in found.packages}:
            if option == "--packages-up-to":
                names = [package.name for package in needed(found.packages, names)]
            made = StudentsBuilds().build(found, (lambda _: names) if option else None)
            try:
                return _take_over(made)
            except CannotCopyBuild:
                pass  # the real colcon reports the reason
    command = python_child("-m", "colcon", *arguments).command
    os.execv(command[0], command)
    return 1


def _chosen(arguments: Sequence[str]) -> tuple[str, list[str]] | None:
    """Return the option and the package names of a plain build; None for any other command."""
    match list(arguments):
        case ["build"]:
            return "", []
        case ["build", ("--packages-select" | "--packages-up-to") as option, *names]:
            return (option, names) if names and not any(name.startswith("-") for name in names) else None
    return None


def _take_over(made: Build) -> int:
    """Copy the build into the workspace, and print what colcon would print. Return the exit code.

    Raises:
        CannotCopyBuild: The build cannot be copied into the workspace's install folder.
    """
    if not made.ok and not made.log:
        print(f"colcon build: {made.line}")  # the build did not even begin
        return 1
    if not made.ok:
        print(f"{made.log.rstrip()}\nFailed   <<< {made.package} [{made.seconds:.2f}s, exited with code 1]")
        print(f"\nSummary: 0 packages finished [{made.seconds:.2f}s]\n  1 package failed: {made.package}")
        return 1
    copy_to_workspace(made)
    names = [prefix.name for prefix in made.prefixes]
    for folder in BESIDE:
        (made.workspace / folder).mkdir(exist_ok=True)
        (made.workspace / folder / "COLCON_IGNORE").touch()
    for name in names:
        print(f"Starting >>> {name}\nFinished <<< {name} [{made.seconds / len(names):.2f}s]")
    print(f"\nSummary: {len(names)} package{'s' * (len(names) != 1)} finished [{made.seconds:.2f}s]")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
