"""A process that executes tasks one after the other: lines of JSON on the socket that is its standard input.

It is a process of its own also when there is only one notebook to grade, because it makes itself the parent
of every daemon that a submission starts, and ends them all. When the grader that started it goes away, so
does it.
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

from autograder.boxes.execution import Ended, Execution
from autograder.boxes.fork_server import Addresses
from autograder.boxes.limits import raise_own
from autograder.boxes.place import BoxedPlace, JudgeSetting, UnboxedPlace
from autograder.boxes.runner import Unfinished, run_notebook
from autograder.boxes.sandbox import NoSandbox
from autograder.grading.returning.page_budget import too_costly
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

    from autograder.boxes.execution import Cell
    from autograder.boxes.limits import Left
    from autograder.verdict import Verdict

JUDGE = "autograder.judge.serving.process:JudgeProcess"
LAST_SECONDS = 10.0
"""Seconds that a worker has to end in good order once its grader is gone; a grader that lives gives it less."""
MOST_EVIDENCE = 4_000_000
"""Bytes of evidence of one notebook, as much as ten checks can have; that of later checks is not kept."""


def main(arguments: list[str]) -> None:
    """Work until the grader hangs up.

    Args:
        arguments: The scratch folder, what makes a judge (``module:class``), and where the fork servers listen,
            as JSON.
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
    """Execute one task; whatever fails on our side is in the result.

    Args:
        task: The task.
        scratch: Where a folder for it is made.
        judge: Makes a judge from a socket's path, a seed and what starts its process.
        addresses: Where the fork servers listen; without one for supervisors there is no sandbox.
    """
    try:
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(scratch_folder(scratch))
            execution = _execute(task, folder, judge, addresses, stack)
        return replace(execution, as_typed=too_costly(task.cells))
    except Exception as error:
        return task.in_trouble(f"{type(error).__name__}: {error}")
    finally:
        # Also when we are being ended: nothing of the submission may outlive us.
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
        start=place.start_kernel,
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
    """Return whether a check that the judge makes came to its cell's time limit.

    Each wait of the judge's has a limit of its own, so that mostly tells of a crowded machine.
    """
    judged = [cell.check is not None and not cell.check.asserts for cell in cells]
    runs = zip(judged, execution.cells, strict=True)
    return any(made and run.ended is Ended.TIMED_OUT for made, run in runs)


def patiently(seconds: float) -> Left:
    """For so many seconds that the machine has for it, as the judge counts its own: crowded, each lasts longer."""
    patience = Patience(seconds)
    return lambda: patience.left


class _Judges:
    """A judge for each check, on the network where the check takes place; one lives at a time.

    Tells a check that nobody asked for from one that the judge itself had trouble with.

    Args:
        made: Makes a judge that is not started, for programs or for the notebook's own nodes.
        runners: The exercises whose subjects are programs.
        first: The exercise of the first check; its judge starts beside the kernel.

    Attributes:
        evidence: What the verdicts follow from, by exercise.
        crowded: One of them may be due to a crowded machine.
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
    """Loopback only, plain logs on stdout, and a domain of its own for the notebook's demonstrations."""
    if boxed:
        # Nobody else is on the network: any domain is the notebook's own.
        return {**boxed_ros_environment(), "ROS_DOMAIN_ID": "0"}
    return {**ros_environment(), "ROS_DOMAIN_ID": str(stack.enter_context(lease()))}


def _imported(name: str) -> Any:
    module, _, attribute = name.partition(":")
    return getattr(importlib.import_module(module), attribute)


def _tasks(grader: Lines) -> Iterator[bytes]:
    """Tasks as they come. When the grader goes away, end this process; in the middle of a task by force, if it must be.

    The end of the conversation is the one sign of it: the system sends its own (PR_SET_PDEATHSIG) when the thread ends
    that has started this process, and in a grader threads come and go.
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
        # Something waits for what does not come, and so does whoever would tidy up.
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
