"""Executes one task: starts its boxes, kernel, judge and workspace service, runs the notebook, and ends them all.

The workspace service builds and runs workspaces and launch files for the checks of the notebook.
"""

from __future__ import annotations

import contextlib
import functools
import os
import shlex
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

from autograder import exercises
from autograder.boxes.box_connection import NoSandbox
from autograder.boxes.run_limits import Ended
from autograder.boxes.visible_host import kernel_environment
from autograder.execution.notebook_processes import (
    SHARED_FOLDER,
    BoxedProcesses,
    NotebookSetting,
    UnboxedProcesses,
)
from autograder.execution.notebook_runner import Unfinished, run_notebook
from autograder.safe_files import scratch_folder
from autograder.workspaces.boxed_jobs import BoxedJobs
from autograder.workspaces.builds import build_cache, students_builds
from autograder.workspaces.graded_builds import build_ahead
from autograder.workspaces.grading_service import ServiceSockets, WorkspaceService
from autograder.workspaces.jobs import PlainJobs
from environment.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from pathlib import Path

    from autograder.boxes.fork_server import Addresses
    from autograder.boxes.run_limits import Patient
    from autograder.execution.executed_cells import Cell, Execution
    from autograder.grading.grading_task import Task
    from autograder.verdict import Verdict


MOST_EVIDENCE = 4_000_000
"""The maximum size in bytes of the evidence of one notebook, enough for ten checks. If the evidence of a further check
would exceed this size, it is not kept.
"""


@dataclass(frozen=True)
class JudgeKind:
    """The judge of a task, and the ROS settings with which judge and subject meet.

    Attributes:
        make: Returns a judge that is not started yet, such as
            :class:`autograder.judge.controlled_judge.JudgeProcess`. Its arguments are the path of a socket, a seed, and
            a function that starts the judge's process.
        variables: The environment variables of the judge.
        readable: The files outside the package that the judge reads.
        ros_variables: The environment variables of ROS for the subject, without the domain.
        lease_domain: Returns a context manager that reserves a ROS domain while its block runs.
        patient: Turns a time limit into a deadline, which gets later while the machine is overloaded.
    """

    make: Callable[..., Any]
    variables: Mapping[str, str]
    readable: Sequence[Path]
    ros_variables: Mapping[str, str]
    lease_domain: Callable[[], contextlib.AbstractContextManager[int]]
    patient: Patient


def execute(
    task: Task,
    scratch: Path,
    judge: JudgeKind,
    addresses: Addresses,
    began: Callable[[BoxedProcesses | UnboxedProcesses], None] = lambda _: None,
) -> Execution:
    """Execute one task.

    Args:
        scratch: The folder in which the task gets its own folder.
        addresses: The addresses of the fork servers, which for a boxed task must include the one for supervisors.
        began: Called with the boxes of the task before anything runs in them.

    Raises:
        Exception: The grader itself failed.
    """
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(scratch_folder(scratch))
        return _execute(task, folder, judge, addresses, stack, began)


def _execute(
    task: Task,
    folder: Path,
    judge: JudgeKind,
    addresses: Addresses,
    stack: contextlib.ExitStack,
    began: Callable[[BoxedProcesses | UnboxedProcesses], None],
) -> Execution:
    # Without a supervisor nothing could make the boxes, and a submission must never run outside of one by mistake.
    if task.boxed and not addresses.supervisors:
        raise NoSandbox("this task must run in a box, but no box can be made here")
    boxed = task.boxed
    kind: type[BoxedProcesses] | type[UnboxedProcesses] = BoxedProcesses if boxed else UnboxedProcesses
    paths = _make_paths(task, folder)
    # The domain is leased before any process starts, because each of them gets it as an environment variable.
    domain = str(stack.enter_context(judge.lease_domain()))
    setting = NotebookSetting(
        folder,
        task.limits,
        task.files,
        {**judge.ros_variables, "ROS_DOMAIN_ID": domain, **paths.variables()},
        judges_variables=judge.variables,
        judges_folders=[*judge.readable, paths.judges_folder],
        programs=bool(paths.runners),
    )
    processes = kind(addresses, setting)
    stack.enter_context(processes)
    # From here on an order can be canceled: `began` tells the executor which boxes to end, before they hold a program.
    began(processes)
    # The service outlives the notebook and ends before the boxes, in which its builds and programs run.
    stack.enter_context(_workspace_service(paths, processes, addresses, judge.ros_variables))

    def new_judge(of_programs: bool) -> Any:
        start = functools.partial(processes.start_judge, of_programs=of_programs)
        process = judge.make(processes.judge_socket, seed=task.seed, start=start)
        process.workspaces = str(paths.judges_socket)
        process.keeps_evidence = True
        process.is_boxed = boxed
        return process

    # The first judge starts while the kernel starts, before a check asks for one: guess from the first check cell
    # whether the subject will be a program.
    first_exercise = next(
        (cell.check.exercise for cell in task.cells if cell.check and not cell.check.asserts), ""
    )
    judges = _Judges(new_judge, paths.runners, first_exercise)
    execution = run_notebook(task.cells, judge=judges, processes=processes, patient=judge.patient)
    # A task that ran alone, and not beside others, has had the whole machine: its result counts, whatever happened.
    short_of_memory = processes.guard.reason() is Ended.OUT_OF_MEMORY
    crowded_out = task.limits.beside and (
        short_of_memory or judges.crowded or _a_check_was_stopped(task.cells, execution)
    )
    return replace(
        execution, crowded_out=crowded_out, cpu_seconds=processes.guard.cpu_seconds, evidence=judges.evidence
    )


def _a_check_was_stopped(cells: Sequence[Cell], execution: Execution) -> bool:
    """Return True if a check by the judge reached the time limit of its cell.

    Usually this means that the machine is busy, because the judge has a shorter limit for each of its waits.
    """
    judged = [cell.check is not None and not cell.check.asserts for cell in cells]
    runs = zip(judged, execution.cells, strict=True)
    return any(is_judged and run.ended is Ended.TIMED_OUT for is_judged, run in runs)


class _Judges:
    """Gives each check a judge on the network of its subject. Only one judge is alive at a time.

    :meth:`close` returns None if the notebook never requested the check, and raises an error if the judge failed.

    Args:
        made: Makes a judge that is not started yet: with True for programs, with False for the notebook's own nodes.
        runners: The exercises whose subjects are programs.
        first: The exercise of the notebook's first check, for which a judge is started in advance.

    Attributes:
        evidence: The evidence of the verdicts, by exercise.
        crowded: True if one of the verdicts may be due to a busy machine.
    """

    def __init__(self, made: Callable[[bool], Any], runners: Collection[str], first: str) -> None:
        self._made, self._runners, self._first = made, runners, first
        self._open = contextlib.ExitStack()
        self._of_programs = False
        self._asked = ""
        self.evidence: dict[str, bytes] = {}
        self.crowded = False

    def __enter__(self) -> Self:
        self._start(self._first in self._runners)
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def _start(self, of_programs: bool) -> None:
        self._of_programs = of_programs
        self._judge = self._open.enter_context(self._made(of_programs))

    def open(self, exercise_id: str) -> None:
        of_programs = exercise_id in self._runners
        if of_programs is not self._of_programs:
            self._open.close()
            self._start(of_programs)
        self._asked = exercise_id
        self._judge.open(exercise_id)

    def close(self) -> Verdict | None:
        report = self._judge.close()
        if report.verdict is None and report.trouble:
            raise (Unfinished if report.unfinished else RuntimeError)(report.trouble)
        if sum(map(len, self.evidence.values())) + len(report.evidence) <= MOST_EVIDENCE and report.evidence:
            self.evidence[self._asked] = report.evidence
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
        path = f"{SHARED_FOLDER / _PROGRAMS}{os.pathsep}{os.environ.get('PATH', os.defpath)}"
        return {"PATH": path, students_builds.GRADERS: str(SHARED_FOLDER / _BUILDS)}


def runners_of(task: Task) -> frozenset[str]:
    """Return the exercises of a task whose subjects the grader itself builds and starts, as programs."""
    checks = {cell.check.exercise for cell in task.cells if cell.check and not cell.check.asserts}
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
    ros_variables: Mapping[str, str],
) -> WorkspaceService:
    """Return the workspace service of a notebook, for use in a ``with`` block that lasts as long as the notebook runs.

    Args:
        paths: The result of :func:`_make_paths`.
        processes: The processes of the notebook, and their boxes.
        addresses: The addresses of the fork servers.
        ros_variables: The environment variables of ROS.
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
    variables = {**ros_variables, "PYTHONUNBUFFERED": "1", "PYTHONFAULTHANDLER": "1"}
    return WorkspaceService(sockets, jobs, builds, variables, folder, ahead)


def _furnish(shared: Path) -> None:
    """Write a replacement for the colcon command into ``shared``, a folder that the student's box can read."""
    programs = shared / _PROGRAMS
    programs.mkdir()
    colcon = programs / "colcon"
    stand_in = python_child("-m", "autograder.workspaces.builds.students_builds").command
    colcon.write_text(f'#!/bin/sh\nexec {shlex.join(stand_in)} "$@"\n')
    colcon.chmod(0o755)
