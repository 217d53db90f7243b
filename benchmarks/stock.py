"""Stock nbgrader on the same class directory and notebooks: one notebook at a time, a cold kernel for each.

Everything is as nbgrader comes, its own ``Execute`` preprocessor included. Two things are added, since without
them the comparison would be one of points lost: the environment variables that every notebook of the course
relies on under nbgrader (logs on standard output), and the limit of a cell, raised from 30 s to the class's,
because a first build of interfaces takes longer on a busy machine.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nbgrader.api import Gradebook

from autograder.boxes.run_limits import Limits
from autograder.grading.classes.class_directory import CONFIG_NAME
from autograder.judge.ros_setup import lease_domain
from benchmarks.machine import Usage, Watch
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from benchmarks.classes import BenchmarkClass

CONFIG = """\
import os

c = get_config()  # noqa: F821  (nbgrader defines it)
c.CourseDirectory.root = os.path.dirname(os.path.abspath(__file__))
c.Execute.timeout = {seconds:g}
"""

Points = dict[tuple[str, str], dict[str, float]]
"""The points of each graded cell, by student and assignment, then by grade_id."""


@dataclass(frozen=True)
class StockRun:
    """The costs of stock nbgrader for a few students.

    Attributes:
        students: The graded students.
        notebooks: How many notebooks that were.
        start_seconds: Start of the ``nbgrader`` command, which a class of any size pays once an assignment.
        seconds: Wall time of each assignment's command.
        points: What the gradebook says.
        usage: The machine meanwhile.
    """

    students: tuple[str, ...]
    notebooks: int
    start_seconds: float
    seconds: dict[str, float]
    points: Points
    usage: Usage

    @property
    def per_notebook(self) -> float:
        """Wall seconds a notebook, the start of the command left out."""
        return (sum(self.seconds.values()) - len(self.seconds) * self.start_seconds) / self.notebooks

    def for_class(self, students: int) -> float:
        """Wall seconds for a class of so many students: extrapolated from each assignment's time a student."""
        return sum(
            self.start_seconds + (seconds - self.start_seconds) / len(self.students) * students
            for seconds in self.seconds.values()
        )


def run_stock(made: BenchmarkClass, folder: Path, students: Sequence[str]) -> StockRun:
    """Grade some students of a class with stock nbgrader, in a copy of its directory.

    Args:
        made: The class; nothing is written into it.
        folder: The folder for the copy.
        students: The students that are graded.
    """
    copy_for_stock(made, folder, students)
    start = _start_seconds(folder)
    seconds = {}
    with _environment() as environment, Watch() as watch:
        for assignment in made.assignments:
            seconds[assignment] = _autograde(folder, environment, watch, assignment)
    assert watch.usage is not None
    return StockRun(
        students=tuple(students),
        notebooks=len(students) * len(seconds),
        start_seconds=start,
        seconds=seconds,
        points=points_in(folder, made.assignments, students),
        usage=watch.usage,
    )


def copy_for_stock(made: BenchmarkClass, folder: Path, students: Sequence[str]) -> None:
    """Copy a class, with a configuration that names nothing of ours, and only some of its students."""
    folder.mkdir(parents=True)
    shutil.copytree(made.path / "source", folder / "source")
    shutil.copy(made.path / "gradebook.db", folder)
    for student in students:
        shutil.copytree(made.path / "submitted" / student, folder / "submitted" / student)
    (folder / CONFIG_NAME).write_text(CONFIG.format(seconds=Limits.cell_seconds))


def points_in(path: Path, assignments: Sequence[str], students: Sequence[str]) -> Points:
    """What a class's gradebook says about some students."""
    found: Points = {}
    with closing(Gradebook(f"sqlite:///{path / 'gradebook.db'}")) as book:
        for assignment in assignments:
            for submission in book.find_assignment(assignment).submissions:
                if submission.student.id in students:
                    found[submission.student.id, assignment] = {
                        grade.name: float(grade.score or 0.0)
                        for notebook in submission.notebooks
                        for grade in notebook.grades
                    }
    return found


def _start_seconds(folder: Path) -> float:
    """How long the command takes that finds nothing to do."""
    began = time.monotonic()
    subprocess.run(
        [*_COMMAND, "autograde", "--help"], cwd=folder, check=True, capture_output=True, env=dict(os.environ)
    )
    return time.monotonic() - began


_COMMAND = tuple(python_child("-W", "ignore", "-m", "nbgrader").command)


def _autograde(folder: Path, environment: Mapping[str, str], watch: Watch, assignment: str) -> float:
    began = time.monotonic()
    with (folder / "nbgrader.log").open("ab") as log:
        done = subprocess.run(
            [*_COMMAND, "autograde", assignment],
            cwd=folder,
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            check=False,
            preexec_fn=watch.prepare,
        )
    if done.returncode:
        raise RuntimeError(f"nbgrader autograde {assignment} failed; see {folder / 'nbgrader.log'}")
    return time.monotonic() - began


@contextmanager
def _environment() -> Iterator[dict[str, str]]:
    """A terminal's environment with what the class's own configuration sets for ``nbgrader validate``."""
    with lease_domain() as domain:
        yield {
            **os.environ,
            "RCUTILS_LOGGING_USE_STDOUT": "1",
            "RCUTILS_COLORIZED_OUTPUT": "0",
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_DOMAIN_ID": str(domain),
        }
