"""Executes one task: starts its boxes, kernel, judge and workspace service, runs the notebook, and ends them all.

The workspace service builds and runs workspaces and launch files for the checks of the notebook.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import os
import shlex
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

from autograder import exercises
from autograder.boxes.box_connection import NoSandbox
from autograder.boxes.run_limits import Ended
from autograder.boxes.visible_host import box_environment, kernel_environment
from autograder.execution.notebook_processes import (
    SHARED_FOLDER,
    BoxedProcesses,
    NotebookSetting,
    UnboxedProcesses,
)
from autograder.execution.notebook_runner import Unfinished, run_notebook
from autograder.judge import controlled_judge
from autograder.judge.machine_fitness import Patience
from autograder.judge.ros_setup import boxed_ros_environment, lease_domain, ros_environment
from autograder.safe_files import scratch_folder
from autograder.workspaces.boxed_jobs import BoxedJobs
from autograder.workspaces.builds import build_cache, students_builds
from autograder.workspaces.graded_builds import build_ahead
from autograder.workspaces.grading_service import ServiceSockets, WorkspaceService
from autograder.workspaces.jobs import PlainJobs
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from autograder.boxes.fork_server import Addresses
    from autograder.boxes.run_limits import Left
    from autograder.execution.executed_cells import Cell, Execution
    from autograder.grading.grading_task import Task
    from autograder.verdict import Verdict


MOST_EVIDENCE = 4_000_000
"""The maximum size in bytes of the evidence of one notebook, enough for ten checks. If the evidence of a further check
would exceed this size, it is not kept.
"""


class NoDrawing(RuntimeError):
    """The inputs of an exercise for this submission are not known, so it cannot be checked."""


def execute(
    task: Task,
    judge: str,
    scratch: Path,
    addresses: Addresses,
    began: Callable[[BoxedProcesses | UnboxedProcesses], None] = lambda _: None,
) -> Execution:
    """Execute one task.

    Args:
        judge: The Python class that makes a judge, as ``module:class``.
        scratch: The folder in which the task gets its own folder.
        addresses: The addresses of the fork servers, which for a boxed task must include the one for supervisors.
        began: Called with the boxes of the task before anything runs in them.

    Raises:
        Exception: The grader itself failed.
    """
    # Without a supervisor nothing could make the boxes, and a submission must never run outside of one by mistake.
    if task.boxed and not addresses.supervisors:
        raise NoSandbox("this task must run in a box, but no box can be made here")
    with contextlib.ExitStack() as stack:
        paths = _make_paths(task, stack.enter_context(scratch_folder(scratch)))
        # The domain is leased before any process starts, because each of them gets it as an environment variable. A box
        # has a network of its own, without other nodes, so any domain is free there.
        domain = 0 if task.boxed else stack.enter_context(lease_domain())
        setting = NotebookSetting(
            paths.folder,
            task.limits,
            task.files,
            {**ros_variables(boxed=task.boxed), "ROS_DOMAIN_ID": str(domain), **paths.variables()},
            judges_variables=controlled_judge.environment(boxed=task.boxed),
            judges_folders=[*controlled_judge.readable(), paths.judges_folder],
            programs=bool(paths.runners),
        )
        kind: type[BoxedProcesses] | type[UnboxedProcesses] = (
            BoxedProcesses if task.boxed else UnboxedProcesses
        )
        processes = kind(addresses, setting)
        stack.enter_context(processes)
        # From here on an order can be canceled: `began` tells the executor which boxes to end, before they hold a
        # program.
        began(processes)
        # The service outlives the notebook and ends before the boxes, in which its builds and programs run.
        stack.enter_context(_workspace_service(paths, processes, addresses))
        judges = _Judges(task, judge, paths, processes)
        execution = run_notebook(task.cells, judge=judges, processes=processes, patient=_patiently)
        # A task that ran alone, and not beside others, has had the whole machine: its result counts, whatever happened.
        short_of_memory = processes.guard.reason() is Ended.OUT_OF_MEMORY
        crowded_out = task.limits.beside and (
            short_of_memory or judges.crowded or _a_check_was_stopped(task.cells, execution)
        )
        return replace(
            execution,
            crowded_out=crowded_out,
            cpu_seconds=processes.guard.cpu_seconds,
            evidence=judges.evidence,
        )


def ros_variables(*, boxed: bool) -> Mapping[str, str]:
    """Return the environment variables of ROS for a subject, without the domain."""
    return boxed_ros_environment() if boxed else ros_environment()


def _patiently(seconds: float) -> Left:
    """Return a function that returns the seconds left of a limit, which gets longer on an overloaded machine."""
    patience = Patience(seconds)
    return lambda: patience.left


def _a_check_was_stopped(cells: Sequence[Cell], execution: Execution) -> bool:
    """Return True if a check by the judge reached the time limit of its cell.

    Usually this means that the machine is busy, because the judge has a shorter limit for each of its waits.
    """
    return any(
        cell.check is not None and not cell.check.asserts and run.ended is Ended.TIMED_OUT
        for cell, run in zip(cells, execution.cells, strict=True)
    )


class _Judges:
    """Gives each check a judge on the network of its subject. Only one judge is alive at a time.

    :meth:`close` returns None if the notebook never requested the check, and raises an error if the judge failed.

    Args:
        made: The Python class that makes a judge that is not started yet, such as
            :class:`autograder.judge.controlled_judge.JudgeProcess`, as ``module:class``.

    Attributes:
        evidence: The evidence of the verdicts, by exercise; of a recorded solution, the recording.
        crowded: True if one of the verdicts may be due to a busy machine.
    """

    def __init__(
        self, task: Task, made: str, paths: _Paths, processes: BoxedProcesses | UnboxedProcesses
    ) -> None:
        module, _, name = made.partition(":")
        self._made = getattr(importlib.import_module(module), name)
        self._task, self._paths, self._processes = task, paths, processes
        self._open = contextlib.ExitStack()
        self._asked = ""
        self.evidence: dict[str, bytes] = {}
        self.crowded = False

    def __enter__(self) -> Self:
        # The first judge starts while the kernel starts, before a check asks for one: guess from the first check cell
        # whether the subject will be a program.
        judged = (check.exercise for check in self._task.checks.values() if not check.asserts)
        self._start(next(judged, "") in self._paths.runners)
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def _start(self, of_programs: bool) -> None:
        start = functools.partial(self._processes.start_judge, of_programs=of_programs)
        judge = self._made(self._processes.judge_socket, seed=self._task.seed, start=start)
        judge.workspaces = str(self._paths.judges_socket)
        judge.keeps_evidence = True
        judge.is_boxed = self._task.boxed
        self._judge, self._of_programs = self._open.enter_context(judge), of_programs

    def open(self, exercise_id: str) -> None:
        of_programs = exercise_id in self._paths.runners
        if of_programs is not self._of_programs:
            self._open.close()
            self._start(of_programs)
        self._asked = exercise_id
        if self._task.records:
            self._judge.open(exercise_id, record=True, drawing=self._task.records)
        elif drawing := self._task.drawings.get(exercise_id):
            self._judge.open(exercise_id, drawing=drawing)
        elif drawing is None:  # all submissions get the same inputs
            self._judge.open(exercise_id)
        else:
            raise NoDrawing(f"the solution of {exercise_id} could not be recorded with inputs of this class")

    def close(self) -> Verdict | None:
        report = self._judge.close()
        if report.verdict is None and report.trouble:
            raise (Unfinished if report.unfinished else RuntimeError)(report.trouble)
        evidence = report.evidence if report.reference is None else report.reference.encode()
        if sum(map(len, self.evidence.values())) + len(evidence) <= MOST_EVIDENCE and evidence:
            self.evidence[self._asked] = evidence
        self.crowded = self.crowded or report.crowded
        verdict: Verdict | None = report.verdict
        return verdict


_BUILDS, _PROGRAMS = "builds", "bin"


@dataclass(frozen=True)
class _Paths:
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
        path = f"{SHARED_FOLDER / _PROGRAMS}{os.pathsep}{box_environment().get('PATH', os.defpath)}"
        return {"PATH": path, students_builds.GRADERS: str(SHARED_FOLDER / _BUILDS)}


def runners_of(task: Task) -> frozenset[str]:
    """Return the exercises of a task whose subjects the grader itself builds and starts, as programs."""
    checks = {check.exercise for check in task.checks.values() if not check.asserts}
    return frozenset(name for name in checks & set(exercises.all_ids()) if exercises.get(name).runner)


def _make_paths(task: Task, folder: Path) -> _Paths:
    """Make the folder for the judge's socket. Call this before the boxes of the notebook are made.

    Args:
        folder: A folder that only this notebook uses. Its path must be short, because it will contain a Unix socket.
    """
    paths = _Paths(folder, task.boxed, runners_of(task))
    paths.judges_folder.mkdir()
    return paths


def _workspace_service(
    paths: _Paths,
    processes: BoxedProcesses | UnboxedProcesses,
    addresses: Addresses,
) -> WorkspaceService:
    """Return the workspace service of a notebook, for use in a ``with`` block that lasts as long as the notebook runs.

    Args:
        paths: The result of :func:`_make_paths`.
        processes: The processes of the notebook, and their boxes.
        addresses: The addresses of the fork servers.
    """
    folder = paths.folder / "work-of-jobs"
    folder.mkdir()
    jobs: BoxedJobs | PlainJobs
    builds, ahead = build_cache.graders_root(), None
    if isinstance(processes, BoxedProcesses):
        jobs = BoxedJobs(addresses.supervisors, processes.programs, folder, addresses.programs)
        _furnish(processes.shared)
        if paths.runners:
            build_ahead(builds, jobs)
        builds, ahead = folder / "builds", builds
        builds.mkdir(mode=0o700)
        sockets = ServiceSockets(paths.judges_socket, processes.shared / _BUILDS)
    else:
        jobs = PlainJobs(kernel_environment(folder / "home", {}), handed_in=True)
        sockets = ServiceSockets(paths.judges_socket, None)
    # PYTHONUNBUFFERED: output comes without delay. PYTHONFAULTHANDLER: a program that hangs can print the stacks of its
    # threads.
    variables = {**ros_variables(boxed=paths.boxed), "PYTHONUNBUFFERED": "1", "PYTHONFAULTHANDLER": "1"}
    return WorkspaceService(sockets, jobs, builds, variables, folder, ahead)


def _furnish(shared: Path) -> None:
    """Write a replacement for the colcon command into ``shared``, a folder that the student's box can read."""
    programs = shared / _PROGRAMS
    programs.mkdir()
    colcon = programs / "colcon"
    stand_in = python_child("-m", "autograder.workspaces.builds.students_builds").command
    colcon.write_text(f'#!/bin/sh\nexec {shlex.join(stand_in)} "$@"\n')
    colcon.chmod(0o755)
