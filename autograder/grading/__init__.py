"""Grading a class: an nbgrader course directory whose notebooks are judged on the wire.

The commands come in here. Imports are inside the functions: nbgrader alone takes more than a second.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

# jsonschema, which nbformat and nbgrader import, loads a grammar of internationalised addresses where it finds one:
# a second at every start, for a check that no notebook asks for. It does without where the import fails.
sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from rich.console import Console

    from autograder.grading.new_class import NewClass
    from autograder.grading.report import GradeReport


def new_class(path: Path, course_root: Path, *, assignments: Sequence[str] = ()) -> NewClass:
    """Make a class directory; see :func:`autograder.grading.new_class.new_class`.

    Raises:
        GradingError: It cannot be made; the message says what to do.
    """
    from autograder.grading.new_class import new_class as make

    return make(path, course_root, assignments=assignments)


def grade(
    path: Path,
    *,
    assignments: Sequence[str] = (),
    students: Sequence[str] = (),
    again: bool = False,
    jobs: int | None = None,
    unsafe_no_sandbox: bool = False,
    scheduler: str | None = None,
    as_json: bool = False,
    console: Console | None = None,
) -> GradeReport:
    """Grade a class and print what came of it; see :func:`autograder.grading.batch.grade`.

    Args:
        path: The class directory.
        assignments: Only these; all by default.
        students: Only these; all by default.
        again: Execute everything anew, also what is unchanged.
        jobs: Notebooks executed at once; as many as load and memory allow by default.
        unsafe_no_sandbox: Run submissions with all rights of whatever process executes them.
        scheduler: The address of a Dask scheduler whose workers execute the notebooks; this machine by default.
        as_json: Print one JSON object instead of the table.
        console: Where the result is printed; standard output by default. Progress goes to standard error.

    Raises:
        GradingError: The class cannot be graded; the message says what to do.
    """
    from autograder.grading import sandboxing
    from autograder.grading.batch import grade as grade_class

    if unsafe_no_sandbox:
        sandboxing.switch_off(path)
    report = grade_class(
        path, assignments=assignments, students=students, again=again, jobs=jobs, scheduler=scheduler
    )
    if as_json:
        from autograder.grading.machine_form import report_json

        sys.stdout.write(f"{report_json(report).decode()}\n")
    else:
        from autograder.grading.showing import show

        show(report, console)
    return report


def demo(path: Path, *, console: Console | None = None) -> GradeReport:
    """Make the sample class where it is not there yet, grade it and print the result.

    Where no sandbox is possible it is graded without one, and says so: the samples are the course's own.

    Raises:
        GradingError: It cannot be made or graded; the message says what to do.
    """
    from autograder.boxes.sandbox import why_impossible
    from autograder.grading import sandboxing
    from autograder.grading.sample_class import demo as show_sample

    if why_impossible():
        sandboxing.switch_off(path)
    return show_sample(path, console=console)
