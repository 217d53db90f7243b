"""``python -m benchmarks``: all figures in one run, printed, and kept beside this file."""

from __future__ import annotations

import argparse
import datetime
import os
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course
from autograder.safe_files import fresh_folder
from benchmarks import figures, results
from benchmarks.box_start import measure_box_start
from benchmarks.classes import BenchmarkClass, make_class
from benchmarks.execution import measure_execute
from benchmarks.floor import Floor, measure_floor
from benchmarks.interrupt import measure_interrupts
from benchmarks.machine import Usage, Watch, machine
from benchmarks.ours import OurRun, diagnosed, problems_of, run_ours
from benchmarks.overload import differences, run_overloaded, verdicts_of
from benchmarks.regrade import measure_regrade
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
        floor_rounds: How often the check cells are measured.
        regraded: Students in the class that is regraded.
        overloaded: Students in the class that is graded under load.
        turns: Of starting a box.
        executed: Notebooks that ``autograder execute`` runs; all where empty.
        interrupted: Notebooks that are graded before each Ctrl-C.
    """

    name: str
    students: int
    assignments: tuple[str, ...]
    sampled: int
    floor_rounds: int
    regraded: int
    overloaded: int
    turns: int
    executed: tuple[str, ...]
    interrupted: tuple[int, ...]


FULL = Form("full", 24, (), 2, 1, 100, 3, 20, (), (1, 3, 5))
SHORT = Form("short", 2, ("exercise_1_2",), 1, 1, 5, 1, 3, ("exercise_1_2",), (1,))


@dataclass
class _Run:
    """One run of the benchmark."""

    form: Form
    folder: Path
    figures: list[results.Figure] = field(default_factory=list)
    differences: list[str] = field(default_factory=list)

    def all(self) -> None:
        """Measure everything; stock nbgrader and ours by turns."""
        for part in (
            self.class_against_stock,
            self.small_costs,
            self.regrade,
            self.under_load,
            self.interrupt,
            self.execute,
        ):
            try:
                part()
            except (RuntimeError, OSError, subprocess.SubprocessError) as error:
                # The other figures are worth having all the same.
                reason = " ".join(str(error).split())[:300]
                self.differences.append(f"{part.__name__} could not be measured: {reason}")

    def class_against_stock(self) -> None:
        """Throughput, points, cores, memory, check cells."""
        form = self.form
        made = make_class(self.folder / "class", form.students, form.assignments)
        sampled = made.students[: form.sampled]
        stock: list[StockRun] = []
        ours: OurRun | None = None
        for number, student in enumerate(sampled):
            with _told(f"stock nbgrader, {student}"):
                stock.append(run_stock(made, self.folder / f"stock-{number}", [student], feedback=False))
            if ours is None:
                with _told(f"autograder grade, {form.students} students"):
                    ours = run_ours(made, self.folder / "grade.log")
        assert ours is not None
        floor: list[Floor] = []
        with _told("check cells"), Watch() as watch:
            for _ in range(form.floor_rounds):
                floor += measure_floor(made, sampled)
        load = _load(watch)
        honest, wrong = _compare_points(made, stock, ours)
        self.differences += [*wrong, *(f"graded here: {problem}" for problem in problems_of(ours))]
        self.figures += [
            figures.throughput(stock, ours, form.students),
            figures.points(wrong, honest),
            figures.busy(ours),
            *figures.memory(ours),
            *figures.checks(floor, load),
        ]

    def small_costs(self) -> None:
        """What a box adds."""
        with _told("starting boxes"), Watch() as watch:
            measured = measure_box_start(self.form.turns)
        self.figures.append(figures.box_start(measured, _load(watch)))

    def regrade(self) -> None:
        """An unchanged class."""
        made = make_class(self.folder / "unchanged", self.form.regraded, self.form.assignments)
        with _told(f"regrading {self.form.regraded} students"), Watch() as watch:
            spent = measure_regrade(made, 3)
        self.figures.append(figures.regrade(spent, self.form.regraded, _load(watch)))

    def under_load(self) -> None:
        """The same verdicts on a machine that is asked for far too much."""
        made = make_class(self.folder / "loaded", self.form.overloaded, self.form.assignments)
        with _told("verdicts, calm"):
            calm = run_ours(made, self.folder / "calm.log", "--jobs", "2")
        with _told("verdicts, overloaded"):
            loaded = run_overloaded(made, self.folder / "loaded.log")
        found = verdicts_of(calm)
        wrong = differences(found, verdicts_of(loaded))
        self.differences += wrong
        self.figures.append(figures.overload(wrong, len(found), figures.load_of(loaded.usage)))

    def interrupt(self) -> None:
        """Ctrl-C."""
        made = make_class(self.folder / "stopped", self.form.students, self.form.assignments)
        with _told("Ctrl-C"), Watch() as watch:
            spent = measure_interrupts(made, self.form.interrupted)
        self.figures.append(figures.interrupt(spent, _load(watch)))

    def execute(self) -> None:
        """Every notebook of the course."""
        with _told("autograder execute"), Watch() as watch:
            run = measure_execute(self.form.executed)
        self.figures.append(figures.execute(run, _load(watch)))


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


def _load(watch: Watch) -> str:
    usage: Usage | None = watch.usage
    assert usage is not None
    return f"load {usage.load:.1f}, cores {usage.busy:.0%} busy"


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
        form = Form(**{**form.__dict__, "students": chosen.students})
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    folder = fresh_folder("benchmark-")
    try:
        found = measure(form, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(results.markdown(found))
    output = chosen.output or (None if chosen.short else RESULTS)
    if output is not None:
        results.write(found, output)
        if output == RESULTS:
            results.put_into(PAGE, found)
    return 0


def measure(form: Form, folder: Path) -> results.Results:
    """Measure in a folder.

    Args:
        form: How much.
        folder: For the classes; empty.
    """
    began = time.monotonic()
    run = _Run(form, folder)
    run.all()
    return results.Results(
        machine=machine(),
        when=datetime.datetime.now(tz=datetime.UTC).date().isoformat(),
        form=form.name,
        minutes=(time.monotonic() - began) / 60,
        figures=tuple(run.figures),
        notes=NOTES,
        differences=tuple(run.differences),
    )


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
