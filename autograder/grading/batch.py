"""Grades a class: the list of the steps, and the command that takes a class through them.

The order of the steps ensures that no failure leaves a wrong grade. First, grades that may be outdated are set to zero
in the gradebook. Then each result is stored in the class's store, and entered into the gradebook when its submission is
complete. So if the run is killed, the gradebook contains only zeros and finished grades, and the next run grades the
rest.

A class may have any size, because the results of a submission are in memory only until they are written.
"""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable, Generator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder import standard_output
from autograder.grading.batch_steps import Batch
from autograder.grading.class_checks import check_configuration
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.running import execution_backends
from autograder.grading.running.batch_progress import plain_line
from autograder.grading.table.student_list import read_roster
from autograder.grading.tasks.asked_for import AskedFor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import Console

    from autograder.grading.reporting.grade_report import GradeReport


FLOW: tuple[Callable[[Batch, Any], Any], ...] = (
    Batch.find,  # the chosen submissions of the class
    Batch.settle,  # which of them have their grades in the gradebook already
    Batch.find_workers,  # before grades are set to zero: if no task can be executed, the class stays as it is
    Batch.draw,  # records the solution in the class's own inputs, if they are missing, before any submission runs
    Batch.take_back,  # zero points for the others, so that a killed run leaves no outdated grade
    Batch.make_tasks,  # for each notebook: a desk in a box reads the file, and the task is rebuilt from the source
    Batch.execute,  # each task with its kernel and judge in boxes, on this machine or on a cluster
    Batch.keep,  # each result goes into the class's store, from which the next run takes it if this one is killed
    Batch.enter,  # each complete submission goes into ``autograded`` and the gradebook
    Batch.show,  # and gets its feedback pages
    Batch.report,  # all of them, as the gradebook has them now
)
"""The way of a class through a run: each step gets what the step before it returned.

From :meth:`Batch.make_tasks` on, the steps are generators: a submission goes on to the next step while others still
wait, so a class of any size needs little memory.
"""


def grade(
    path: Path,
    *,
    assignments: Sequence[str] = (),
    students: Sequence[str] = (),
    sections: Sequence[str] = (),
    jobs: int | None = None,
    again: bool = False,
    feedback: bool = True,
    console: Console | None = None,
    judge: str = "",
    scheduler: str | None = None,
    dry_run: bool = False,
    lower: str = "",
) -> GradeReport:
    """Grade the submissions of a class.

    Args:
        path: The class directory.
        assignments: The assignments to grade; by default all.
        students: The students to grade; by default all.
        sections: The sections to grade. Their students are graded in addition to those in ``students``.
        jobs: The number of notebooks to execute at the same time; by default as many as processors and memory allow.
        again: True to execute every notebook again, even if it has not changed.
        feedback: True to make the feedback pages for students.
        console: The console for the progress; by default standard error.
        judge: The Python class that makes a judge, as ``module:class``; by default the real judge. For tests.
        scheduler: The address of a Dask scheduler whose workers execute the notebooks; by default this machine
            executes them.
        dry_run: True to leave the gradebook unchanged, and report the students whose points would change. But the
            results are stored, so that the next run only has to enter them.
        lower: ``yes`` to take over points that fell although the same files were handed in, ``no`` to keep the earlier
            points, and empty to ask.

    Returns:
        The report. If a submission could not be graded, the report contains it with zero points and the reason.

    Raises:
        GradingError: The class cannot be graded, for example because another run is grading it, the disk is full, or
            no worker can execute notebooks.
    """
    console = console or standard_output.console(stderr=True)
    directory = ClassDirectory(Path(path))
    check_configuration(directory)
    here = backend = execution_backends.on_this_machine(directory, jobs, judge)
    if scheduler is not None:
        from autograder.grading.cluster import cluster_dispatcher  # the only door to it: few classes need it

        cluster_dispatcher.check_dask()
        cluster_dispatcher.check_address(scheduler)
        tell = functools.partial(plain_line, console)
        backend = cluster_dispatcher.on_cluster(directory, scheduler, judge, tell)
    with directory.lock(), contextlib.ExitStack() as stack:
        execution_backends.remove_leftovers(directory)
        roster = read_roster(directory)
        in_sections = roster.of_sections(sections) if sections else ()
        asked = AskedFor(assignments, [*students, *in_sections], again, feedback, dry_run, lower)
        store = stack.enter_context(ClassStore(directory))
        batch = Batch(directory, store, console, roster, asked, backend, here, stack)
        batch.note(roster.left_out(sections))
        handed_on: Any = ()
        for step in FLOW:
            handed_on = step(batch, handed_on)
            if isinstance(handed_on, Generator):
                stack.callback(handed_on.close)  # if a later step fails, what this one began ends, too
        report: GradeReport = handed_on
        return report
