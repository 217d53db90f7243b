"""Profiles the grader's own process: everything but boxes, which are separate processes."""

from __future__ import annotations

import cProfile
import pstats
from typing import TYPE_CHECKING

from autograder.grading import batch
from benchmarks.classes import make_class

if TYPE_CHECKING:
    from pathlib import Path

_ASSIGNMENTS = ("exercise_1_2", "exercise_1_3", "lab_1_2")
_STUDENTS = 4
_FUNCTIONS = 40


def profile_grade(folder: Path) -> None:
    """Grades a small class under the profiler and prints the functions that took most.

    Args:
        folder: The folder for the class.
    """
    made = make_class(folder, _STUDENTS, _ASSIGNMENTS)
    profiler = cProfile.Profile()
    profiler.enable()
    report = batch.grade(made.path)
    profiler.disable()
    print(f"The main thread of `autograder grade`, {report.executed} notebooks in {report.seconds:.1f} s.")
    print(report.timings.line())
    print("Of the total, waiting for results (queue.get) is free. By cumulative time:")
    pstats.Stats(profiler).sort_stats("cumulative").print_stats(_FUNCTIONS)
