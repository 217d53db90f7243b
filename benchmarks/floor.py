"""The floor: the same cells and the judge's work, in processes that are warm already and nothing around them."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from autograder import exercises
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.tasks.task_making import task_of
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Sequence

    from benchmarks.classes import BenchmarkClass

Cell = tuple[str, float, float, str]
"""The cell's first words, wall seconds, CPU seconds, and the exercise that it checks."""


@dataclass(frozen=True)
class Floor:
    """The costs of one notebook by itself.

    Attributes:
        notebook: Its name.
        seconds: Wall time of all cells.
        cpu: CPU seconds of cells and judge; None if this system does not count them.
        cells: The code cells.
    """

    notebook: str
    seconds: float
    cpu: float | None
    cells: tuple[Cell, ...]

    @property
    def checks(self) -> list[tuple[float, bool]]:
        """Wall seconds of each check cell, and whether it builds a workspace."""
        return [(seconds, builds(exercise)) for _, seconds, _, exercise in self.cells if exercise]


def builds(exercise: str) -> bool:
    """Whether the check of an exercise builds a workspace, and takes what colcon takes."""
    return bool(exercises.get(exercise).runner)


def measure_floor(made: BenchmarkClass, students: Sequence[str]) -> list[Floor]:
    """Run the notebooks of some students exactly as they are graded, one after the other.

    Args:
        made: The class; nothing is written into it.
        students: Whose notebooks.
    """
    directory = ClassDirectory(made.path)
    tasks = [
        task_of(directory, submission, notebook)[0]
        for submission in directory.submissions()[0]
        if submission.student in students
        for notebook in directory.notebooks(submission.assignment)
    ]
    done = subprocess.run(
        python_child("-m", "benchmarks.warm_notebook").command,
        input=b"".join(msgspec.json.encode(task) + b"\n" for task in tasks),
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=dict(os.environ),
        check=True,
    )
    return [msgspec.json.decode(line, type=Floor) for line in done.stdout.splitlines()]
