"""Makes the workspace service of a notebook, which builds and runs workspaces and launch files for the checks."""

from __future__ import annotations

import os
import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.boxes.environment import kernel_environment
from autograder.execution.notebook_boxes import SHARED_FOLDER, BoxedPlace
from autograder.judge.settings import boxed_ros_environment, ros_environment
from autograder.workspaces.builds import cache, own_builds
from autograder.workspaces.built_ahead import build_ahead
from autograder.workspaces.running.boxed_jobs import BoxedJobs
from autograder.workspaces.running.plain_jobs import PlainJobs
from autograder.workspaces.service import ServiceSockets, WorkspaceService
from environment.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from autograder.boxes.fork_server import Addresses
    from autograder.execution.notebook_boxes import UnboxedPlace
    from autograder.grading.task import Task

_BUILDS, _PROGRAMS = "builds", "bin"


@dataclass(frozen=True)
class Arrangement:
    """The paths of one notebook's sockets and folders.

    Attributes:
        folder: A folder that only this notebook uses.
        boxed: True if the notebook runs in boxes.
        runners: The exercises whose subjects the grader itself builds and starts.
    """

    folder: Path
    boxed: bool
    runners: frozenset[str]

    @property
    def judges_folder(self) -> Path:
        """The folder with the judge's socket, which the judge's box sees but the student's box must not see."""
        return self.folder / "jobs"

    @property
    def judges_socket(self) -> Path:
        """The path of the judge's socket, which is the same inside and outside the judge's box."""
        return self.judges_folder / "sock"

    def variables(self) -> Mapping[str, str]:
        """Return environment variables that let ``colcon build`` in the notebook's box use the grader's builds."""
        if not self.boxed:
            return {}
        path = f"{SHARED_FOLDER / _PROGRAMS}{os.pathsep}{os.environ.get('PATH', os.defpath)}"
        return {"PATH": path, own_builds.GRADERS: str(SHARED_FOLDER / _BUILDS)}


def arrange(task: Task, folder: Path) -> Arrangement:
    """Make the folder for the judge's socket, and find the exercises whose subjects are programs.

    Call this before the boxes of the notebook are made.

    Args:
        task: The notebook.
        folder: A folder that only this notebook uses. Its path must be short, because it will contain a Unix socket.
    """
    checks = [cell.check.exercise for cell in task.cells if cell.check and not cell.check.asserts]
    runners = {name: exercises.get(name).runner for name in checks if name in exercises.all_ids()}
    arrangement = Arrangement(
        folder, task.boxed, frozenset(name for name, runner in runners.items() if runner)
    )
    arrangement.judges_folder.mkdir()
    return arrangement


def served(
    arrangement: Arrangement, place: BoxedPlace | UnboxedPlace, addresses: Addresses
) -> WorkspaceService:
    """Return the workspace service of a notebook, for use in a ``with`` block that lasts as long as the notebook runs.

    Args:
        arrangement: The result of :func:`arrange`.
        place: The boxes of the notebook.
        addresses: The addresses of the fork servers.
    """
    folder = arrangement.folder / "work-of-jobs"
    folder.mkdir()
    jobs: BoxedJobs | PlainJobs
    builds, ahead = cache.graders_root(), None
    if isinstance(place, BoxedPlace):
        jobs = BoxedJobs(addresses.supervisors, place.programs, folder, addresses.programs)
        ros = boxed_ros_environment()
        _furnish(place.shared)
        if arrangement.runners:
            build_ahead(builds, jobs)
        builds, ahead = folder / "builds", builds
        builds.mkdir(mode=0o700)
        sockets = ServiceSockets(arrangement.judges_socket, place.shared / _BUILDS)
    else:
        jobs = PlainJobs(kernel_environment(folder / "home", {}), handed_in=True)
        ros = ros_environment()
        sockets = ServiceSockets(arrangement.judges_socket, None)
    # PYTHONUNBUFFERED: output comes without delay. PYTHONFAULTHANDLER: a program that hangs can print the stacks of its
    # threads.
    variables = {**ros, "PYTHONUNBUFFERED": "1", "PYTHONFAULTHANDLER": "1"}
    return WorkspaceService(sockets, jobs, builds, variables, folder, ahead)


def _furnish(shared: Path) -> None:
    """Write a replacement for the colcon command into ``shared``, a folder that the student's box can read."""
    programs = shared / _PROGRAMS
    programs.mkdir()
    colcon = programs / "colcon"
    stand_in = python_child("-m", "autograder.workspaces.builds.colcon_in_class").command
    colcon.write_text(f'#!/bin/sh\nexec {shlex.join(stand_in)} "$@"\n')
    colcon.chmod(0o755)
