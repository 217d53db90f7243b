"""Record the packages that the course's own notebooks build, so that they are built ahead of a class.

Each notebook with a check of a workspace is executed in boxes as a student's is, with the solutions of its master. The
packages that it wants to have built are written into ``solutions/<chapter>/built_ahead.json``.
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

from autograder import course, exercises
from autograder.boxes.fork_server import ForkServers
from autograder.grading.grading_task import Task
from autograder.grading.new_classes.sample_class import _without_markers
from autograder.grading.running import task_execution
from autograder.grading.running.worker_messages import JUDGE
from autograder.grading.tasks.task_making import cells_of
from autograder.judge import controlled_judge
from autograder.judge.ros_setup import boxed_ros_environment
from autograder.masters.master_files import lab_name, masters
from autograder.masters.source_notebooks import source_notebook
from autograder.workspaces.graded_builds import BUILT_AHEAD, GradedBuilds, PackageFiles
from autograder.workspaces.packages import WORKSPACE

if TYPE_CHECKING:
    import argparse

    from autograder.boxes.fork_server import Addresses
    from autograder.workspaces.builds.colcon_build import Build
    from autograder.workspaces.jobs import BuildJob
    from autograder.workspaces.sources import SourceTree


def arguments(parser: argparse.ArgumentParser) -> None:
    """There are none."""
    del parser


def main(options: argparse.Namespace) -> int:
    """Write the files.

    Raises:
        RuntimeError: A notebook could not be executed.
    """
    del options
    root = course.root()
    found: dict[Path, list[PackageFiles]] = {}
    with ForkServers(
        controlled_judge.__name__,
        boxed=True,
        environment=boxed_ros_environment(),
        of_judges=course.variables(),
        interfaces=course.interface_modules(),
    ) as warm:
        for master in masters(root):
            task = _task(master)
            if task is None:
                continue
            built = _built(task, warm.addresses)
            print(f"{task.notebook}: {len(built)} builds", flush=True)
            packages = found.setdefault(master.parents[1], [])
            packages += [files for files in built if files not in packages]
    for chapter, packages in found.items():
        text = json.dumps(packages, ensure_ascii=False, indent=1) + "\n"
        (chapter / BUILT_AHEAD).write_text(text, encoding="utf-8")
    return 0


def _task(master: Path) -> Task | None:
    """The master as a student would hand it in; None if none of its checks builds anything."""
    notebook = source_notebook(master)
    for cell in notebook.cells:
        cell.source = _without_markers(cell.source)  # as a student hands it in
    cells = cells_of(notebook)
    checks = [cell.check.exercise for cell in cells if cell.check and not cell.check.asserts]
    if not any(exercises.get(name).runner for name in checks):
        return None
    return Task("reference", "built-ahead", lab_name(master), cells, seed="built ahead", course="")


def _built(task: Task, addresses: Addresses) -> list[PackageFiles]:
    """The packages that a notebook has had built for it."""
    trees: dict[str, SourceTree] = {}
    entry = GradedBuilds._entry

    def remembering(self: GradedBuilds, found: Build, job: BuildJob, *rest: Any) -> Build:
        made = entry(self, found, job, *rest)
        if made.ok and job.name == WORKSPACE:
            trees[job.tree.digest] = job.tree
        return made

    with (
        tempfile.TemporaryDirectory(prefix="ahead-") as scratch,
        mock.patch.object(GradedBuilds, "_entry", remembering),
        mock.patch.object(task_execution, "build_ahead"),
    ):
        execution = task_execution.execute(task, JUDGE, Path(scratch), addresses)
    if execution.trouble:
        raise RuntimeError(f"{task.notebook}: {execution.trouble}")
    return [_files(tree) for tree in trees.values()]


def _files(tree: SourceTree) -> PackageFiles:
    return {source.path: None if source.data is None else source.data.decode() for source in tree.sources}
