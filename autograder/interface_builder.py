"""Builds interface packages in the user's cache, the same definitions once. It is a process of its own."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.safe_files import HeldFolder
from autograder.workspaces.builds.build_cache import root as cache
from autograder.workspaces.builds.cached_builds import Builds, BuildTookTooLong
from autograder.workspaces.builds.colcon_build import describe_workspace
from autograder.workspaces.builds.install_folder import with_prefixes
from autograder.workspaces.jobs import PlainJobs
from course_runtime.interface_packages import write_package

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.workspaces.builds.build_cache import CachedBuild
    from autograder.workspaces.builds.colcon_build import Build
    from autograder.workspaces.jobs import BuildJob, BuildOutcome


def main(packages: Sequence[str]) -> int:
    """Print the prefix of each built package, or why one cannot be built.

    Args:
        packages: The folders with the definitions.

    Returns:
        The exit code.
    """
    folders = [Path(package) for package in packages]
    build = _build(folders)
    if build.ok:
        print(*build.prefixes, sep="\n")
    else:
        names = build.package or ", ".join(folder.name for folder in folders)
        print(f"{names} cannot be built: {build.line}")
    return not build.ok


def _build(packages: Sequence[Path]) -> Build:
    # ROS from wheels is in this Python's own prefix, where CMake does not look by itself.
    jobs = _AnnouncedJobs(with_prefixes(os.environ, [Path(sys.prefix)], last=True), handed_in=False)
    with HeldFolder("autograder-interfaces-") as workspace:
        for package in packages:
            write_package(package, workspace.path / "src" / package.name)
        try:
            return Builds(cache(), jobs).build(describe_workspace(workspace.path), None)
        except BuildTookTooLong as error:
            return error.build


class _AnnouncedJobs(PlainJobs):
    """Says which packages are built: a first build takes half a minute."""

    def build(self, job: BuildJob, command: Sequence[str], entry: CachedBuild) -> BuildOutcome:
        names = ", ".join(package.name for package in job.packages)
        print(f"autograder: building {names}, once", file=sys.stderr)
        return super().build(job, command, entry)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
