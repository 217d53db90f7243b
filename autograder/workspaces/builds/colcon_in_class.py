"""The command `colcon` in a graded notebook: the grader makes plain builds, and the real colcon does everything else.

A plain build is ``colcon build`` in a workspace, with at most the options ``--packages-select`` or
``--packages-up-to``. As usual, it leaves the packages in ``install`` and lists the finished packages. But it leaves
``log`` empty, and does not leave the files in ``build`` that would make colcon's next build faster.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.workspaces.builds.colcon import look
from autograder.workspaces.builds.install_folder import BESIDE, CannotPlace, place
from autograder.workspaces.builds.own_builds import GRADERS, OwnBuilds
from autograder.workspaces.packages import needed
from environment.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.workspaces.builds.colcon import Build, Targets

UP_TO = "--packages-up-to"


def main(arguments: Sequence[str]) -> int:
    """Request a plain build from the grader, or replace this process by the real colcon. Return the exit code.

    Args:
        arguments: The arguments of the command line.
    """
    chosen = _chosen(arguments)
    found = look(Path.cwd())
    if os.environ.get(GRADERS) and chosen is not None and not found.trouble and not found.unusable:
        option, names = chosen
        if set(names) <= {package.name for package in found.packages}:
            made = OwnBuilds().build(found, _targets(option, names))
            try:
                return _told(made)
            except CannotPlace:
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


def _targets(option: str, names: Sequence[str]) -> Targets | None:
    if option == UP_TO:
        return lambda found: [package.name for package in needed(found.packages, names)]
    return (lambda _: names) if option else None


def _told(made: Build) -> int:
    """Copy the build into the workspace, and print what colcon would print. Return the exit code.

    Raises:
        CannotPlace: The build cannot be copied into the workspace's install folder.
    """
    if not made.ok and not made.log:
        print(f"colcon build: {made.line}")  # the build did not even begin
        return 1
    if not made.ok:
        print(f"{made.log.rstrip()}\nFailed   <<< {made.package} [{made.seconds:.2f}s, exited with code 1]")
        print(f"\nSummary: 0 packages finished [{made.seconds:.2f}s]\n  1 package failed: {made.package}")
        return 1
    place(made)
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
