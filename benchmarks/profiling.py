"""Where the grader's own process spends its time: everything but boxes, which run beside it."""

from __future__ import annotations

import cProfile
import io
import pstats
from typing import TYPE_CHECKING

from autograder import course
from autograder.grading import batch
from benchmarks.classes import make_class

if TYPE_CHECKING:
    from pathlib import Path

_ASSIGNMENTS = ("exercise_1_2", "exercise_1_3", "lab_1_2")
_STUDENTS = 4
_FUNCTIONS = 40


def profile_grade(folder: Path, output: Path) -> None:
    """Grade a small class under the profiler and keep the functions that took most.

    Args:
        folder: Where the class is made.
        output: A text file.
    """
    made = make_class(folder, _STUDENTS, _ASSIGNMENTS)
    profiler = cProfile.Profile()
    profiler.enable()
    report = batch.grade(made.path)
    profiler.disable()
    text = io.StringIO()
    text.write(
        f"The main thread of `autograder grade`, {report.executed} notebooks in {report.seconds:.1f} s.\n"
        f"{report.timings.line()}\n"
        "Of the total, waiting for results (queue.get) is free. By cumulative time:\n"
    )
    pstats.Stats(profiler, stream=text).sort_stats("cumulative").print_stats(_FUNCTIONS)
    lines = text.getvalue().replace(f"{course.root()}/", "")
    output.write_text("\n".join(_short(line) for line in lines.splitlines() if line.strip()) + "\n")


def _short(line: str) -> str:
    """Without where Python and its packages are installed."""
    for mark in ("site-packages/", "lib/python3"):
        head, found, tail = line.rpartition(mark)
        if found:
            number = head.rpartition(" ")[0]
            return f"{number} {tail}".rstrip()
    return line.rstrip()
