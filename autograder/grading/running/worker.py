"""A process that executes tasks one after the other. It exchanges lines of JSON over the socket on its standard input.

Even a single notebook gets a separate process, because this process becomes the parent of every daemon that a
submission starts, and ends them all. It ends when its grader ends.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import os
import queue
import signal
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import msgspec

from autograder.boxes.fork_server import Addresses
from autograder.boxes.limits import Ended, raise_own
from autograder.boxes.sandbox import NoSandbox
from autograder.execution.notebook_boxes import BoxedPlace, JudgeSetting, UnboxedPlace
from autograder.execution.runner import Unfinished, run_notebook
from autograder.grading.returning.rendering_time import too_costly
from autograder.grading.running.workspace_service import arrange, served
from autograder.grading.task import Task
from autograder.judge.bench.patience import Patience
from autograder.judge.serving import attached
from autograder.judge.serving.domain import lease
from autograder.judge.settings import boxed_ros_environment, ros_environment
from autograder.messages.checks import SOCKET_VARIABLE
from autograder.messages.lines import Hangup, Lines
from autograder.process_trees import adopt_orphans, end_descendants
from autograder.temporary_folders import scratch_folder

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

    from autograder.boxes.limits import Left
    from autograder.execution.cells import Cell, Execution
    from autograder.verdict import Verdict

LAST_SECONDS = 10.0
"""Seconds for a worker to end cleanly after its grader has ended. A running grader allows less time."""
MOST_EVIDENCE = 4_000_000
"""The maximum size in bytes of the evidence of one notebook, enough for ten checks. The evidence of later checks is
dropped.
"""


def main(arguments: list[str]) -> None:
    """Execute tasks until the grader closes the connection.

    Args:
        arguments: The scratch folder, the class that makes a judge (``module:class``), and the addresses of the fork
            servers, as JSON.
    """
    scratch, judge = Path(arguments[0]), _imported(arguments[1])
    addresses = msgspec.json.decode(arguments[2], type=Addresses)
    raise_own()
    adopt_orphans()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    grader = Lines.with_parent()
    for line in _tasks(grader):
        execution = execute(msgspec.json.decode(line, type=Task), scratch, judge, addresses)
        end_descendants()
        grader.say_json(msgspec.json.encode(execution))


def execute(task: Task, scratch: Path, judge: Any, addresses: Addresses) -> Execution:
    """Execute one task. A failure of the grader itself becomes part of the result.

    Args:
        task: The task.
        scratch: The folder in which the task gets its own folder.
        judge: Makes a judge, given the path of a socket, a seed, and a function that starts the judge's process.
        addresses: The addresses of the fork servers. Without the one for supervisors there is no sandbox.
    """
    try:
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(scratch_folder(scratch))
            execution = _execute(task, folder, judge, addresses, stack)
        return replace(execution, as_typed=too_costly(task.cells))
    except Exception as error:
        return task.in_trouble(f"{type(error).__name__}: {error}")
    finally:
        # This happens even if this process is being ended: nothing of the submission may outlive it.
        end_descendants()


def _execute(
    task: Task, folder: Path, judge: Any, addresses: Addresses, stack: contextlib.ExitStack
) -> Execution:
    if task.boxed and not addresses.supervisors:
        raise NoSandbox("this task is for a box, and there is none here")
    boxed = task.boxed
    kind: type[BoxedPlace] | type[UnboxedPlace] = BoxedPlace if boxed else UnboxedPlace
    arrangement = arrange(task, folder)
    place = kind(
        addresses,
        folder,
        task.files,
        {**_ros_variables(stack, boxed=boxed), **arrangement.variables()},
        SOCKET_VARIABLE,
        JudgeSetting(attached.environment(boxed=boxed), [*attached.readable(), arrangement.judges_folder]),
        task.limits,
        programs=bool(arrangement.runners),
    )
    stack.enter_context(place)
    stack.enter_context(served(arrangement, place, addresses))

    def made(of_programs: bool) -> Any:
        start = functools.partial(place.start_judge, of_programs=of_programs)
        process = judge(place.judge_socket, seed=task.seed, start=start)
        process.workspaces = str(arrangement.judges_socket)
        process.keeps_evidence = True
        process.is_boxed = boxed
        return process

    first = next((cell.check.exercise for cell in task.cells if cell.check and not cell.check.asserts), "")
    judges = _Judges(made, arrangement.runners, first)
    execution = run_notebook(
        task.cells,
        judge=judges,
        place=place,
        folder=folder,
        limits=task.limits,
        guard=place.guard,
        patient=patiently,
    )
    short_of_memory = place.guard.reason() is Ended.OUT_OF_MEMORY
    crowded_out = task.limits.beside and (
        short_of_memory or judges.crowded or a_check_was_stopped(task.cells, execution)
    )
    return replace(
        execution, crowded_out=crowded_out, cpu_seconds=place.guard.cpu_seconds, evidence=judges.evidence
    )


def a_check_was_stopped(cells: Sequence[Cell], execution: Execution) -> bool:
    """Return True if a check by the judge reached the time limit of its cell.

    Each wait of the judge has its own limit, so this usually means that the machine is busy.
    """
    judged = [cell.check is not None and not cell.check.asserts for cell in cells]
    runs = zip(judged, execution.cells, strict=True)
    return any(made and run.ended is Ended.TIMED_OUT for made, run in runs)


def patiently(seconds: float) -> Left:
    """A deadline that stretches while the machine is overloaded, as the judge's own deadlines do."""
    patience = Patience(seconds)
    return lambda: patience.left


class _Judges:
    """Makes a judge for each check, on the network of that check. Only one judge is alive at a time.

    It distinguishes a check that the notebook never requested from one in which the judge itself failed.

    Args:
        made: Makes a judge that is not started yet: with True for programs, with False for the notebook's own nodes.
        runners: The exercises whose subjects are programs.
        first: The exercise of the first check. Its judge is started together with the kernel.

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
        report = self._judge.close_report()
        if report.verdict is None and report.trouble:
            raise (Unfinished if report.unfinished else RuntimeError)(report.trouble)
        if sum(map(len, self.evidence.values())) + len(report.evidence) <= MOST_EVIDENCE and report.evidence:
            self.evidence[self._asked] = report.evidence
        self.crowded = self.crowded or report.crowded
        verdict: Verdict | None = report.verdict
        return verdict


def _ros_variables(stack: contextlib.ExitStack, *, boxed: bool) -> Mapping[str, str]:
    """Return variables for ROS on loopback only, plain logs on stdout, and the domain of the demonstrations."""
    if boxed:
        # No other nodes are on this network, so any domain is free.
        return {**boxed_ros_environment(), "ROS_DOMAIN_ID": "0"}
    return {**ros_environment(), "ROS_DOMAIN_ID": str(stack.enter_context(lease()))}


def _imported(name: str) -> Any:
    module, _, attribute = name.partition(":")
    return getattr(importlib.import_module(module), attribute)


def _tasks(grader: Lines) -> Iterator[bytes]:
    """Yield tasks as they come. When the grader ends, end this process, if necessary by force during a task.

    The end of the connection is the only usable sign. The system's signal (PR_SET_PDEATHSIG) comes when the thread
    that started this process ends, and a grader's threads come and go.
    """
    lines: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
    idle = threading.Event()

    def read() -> None:
        with contextlib.suppress(Hangup):
            while True:
                lines.put(grader.hear_json())
        lines.put(None)
        if not idle.is_set():
            os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(LAST_SECONDS)
        # A thread is stuck, and so is the clean-up, which waits for that thread.
        end_descendants()
        os._exit(1)

    threading.Thread(target=read, daemon=True).start()
    while True:
        idle.set()
        line = lines.get()
        if line is None:
            return
        idle.clear()
        yield line


if __name__ == "__main__":
    main(sys.argv[1:])
