"""``python -m benchmarks``: a class here and in stock nbgrader, printed, and kept beside this file."""

from __future__ import annotations

import argparse
import datetime
import os
import shutil
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course
from autograder.safe_files import fresh_folder
from benchmarks import figures, results
from benchmarks.classes import BenchmarkClass, make_class
from benchmarks.machine import machine
from benchmarks.ours import OurRun, diagnosed, problems_of, run_ours
from benchmarks.stock import StockRun, run_stock

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

RESULTS = Path(__file__).with_name("results.json")
PAGE = course.root() / "docs" / "performance.md"


@dataclass(frozen=True)
class Form:
    """How much is measured.

    Attributes:
        name: ``"full"`` or ``"short"``.
        students: In the class that is graded.
        assignments: Of the class; all where empty.
        sampled: Students that stock nbgrader grades, in as many runs.
    """

    name: str
    students: int
    assignments: tuple[str, ...]
    sampled: int


FULL = Form("full", 24, (), 2)
SHORT = Form("short", 2, ("exercise_1_2",), 1)


def measure(form: Form, folder: Path) -> results.Results:
    """Measure in a folder: stock nbgrader and ours by turns.

    Args:
        form: How much.
        folder: For the class, its copies and their logs; empty.

    Raises:
        RuntimeError: A class could not be graded; the message names the log.
    """
    began = time.monotonic()
    made = make_class(folder / "class", form.students, form.assignments)
    stock: list[StockRun] = []
    ours: OurRun | None = None
    for number, student in enumerate(made.students[: form.sampled]):
        with _told(f"stock nbgrader, {student}"):
            stock.append(run_stock(made, folder / f"stock-{number}", [student]))
        if ours is None:
            with _told(f"autograder grade, {form.students} students"):
                ours = run_ours(made, folder / "grade.log")
    assert ours is not None
    honest, wrong = _compare_points(made, stock, ours)
    return results.Results(
        machine=machine(),
        when=datetime.datetime.now(tz=datetime.UTC).date().isoformat(),
        form=form.name,
        minutes=(time.monotonic() - began) / 60,
        figures=(
            figures.throughput(stock, ours, form.students),
            figures.points(wrong, honest),
            figures.busy(ours),
        ),
        notes=NOTES,
        differences=(*wrong, *(f"graded here: {problem}" for problem in problems_of(ours))),
    )


def _compare_points(made: BenchmarkClass, stock: Sequence[StockRun], ours: OurRun) -> tuple[int, list[str]]:
    """How many honest notebooks both have graded, and those whose points differ."""
    both = {key: points for run in stock for key, points in run.points.items() if key in made.honest}
    wrong = [
        f"{student}/{assignment}: {points} in stock nbgrader, {ours.points.get((student, assignment))} here"
        f" ({diagnosed(ours, student, assignment)})"
        for (student, assignment), points in sorted(both.items())
        if points != ours.points.get((student, assignment))
    ]
    return len(both), wrong


@contextmanager
def _told(what: str) -> Iterator[None]:
    print(f"{what} … ", end="", file=sys.stderr, flush=True)
    began = time.monotonic()
    yield
    print(f"{time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, keep."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "--short", action="store_true", help="a minute instead of half an hour; nothing is kept"
    )
    parser.add_argument("--students", type=int, help="students in the class that is graded")
    parser.add_argument("--output", type=Path, help="keep the figures here; beside this program by default")
    chosen = parser.parse_args(arguments)
    form = SHORT if chosen.short else FULL
    if chosen.students:
        form = replace(form, students=chosen.students)
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    folder = fresh_folder("benchmark-")
    found = measure(form, folder)
    # Not if something failed: the logs that the message names are in it.
    shutil.rmtree(folder, ignore_errors=True)
    print(results.markdown(found))
    output = chosen.output or (None if chosen.short else RESULTS)
    if output is not None:
        results.write(found, output)
        if output == RESULTS:
            results.put_into(PAGE, found)
    return 0


NOTES = (
    "Both sides grade the same class directory. `nbgrader autograde` 0.9.6 runs the whole notebook, one at a "
    "time in a cold kernel, with the class's limit of a cell and logs on standard output; `autograder grade` "
    "leaves out the given cells that only demonstrate `ros2` (`c.WireExecute.demonstrations` has them run).",
    "Every fourth student has one wrong answer. Endless loops are left out: stock nbgrader would sit out each "
    "alone.",
    "`autograder grade` builds the packages of the course's own solutions once, ahead of all classes, and "
    "these students hand in those; stock nbgrader builds at each check.",
)


if __name__ == "__main__":
    sys.exit(main())
