"""``python -m benchmarks.warm_notebook``: what the cells of a notebook and the judge's work cost by themselves.

This process has everything imported. For each task that comes in on standard input it forks; the child runs the
cells in an IPython shell of its own, without a kernel, a message or a sandbox, beside a judge that is warm too. What
the child and the judge's own children spend is the floor that a grader can be compared with.
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
import time
from typing import TYPE_CHECKING, Any

import msgspec
import psutil

from autograder.execution.executed_cells import CellType
from autograder.grading.grading_task import Task
from autograder.safe_files import HeldFolder
from benchmarks.machine import CpuGroup

if TYPE_CHECKING:
    from pathlib import Path

_MODULES = (
    "IPython.core.interactiveshell",
    "ipykernel.ipkernel",
    "rclpy",
    "rclpy.node",
    "autograder.notebook",
)


def main() -> None:
    """Answer each task with its floor, as a line of JSON."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    from autograder.judge import ros_setup

    os.environ.update(ros_setup.ros_environment())
    for name in _MODULES:
        __import__(name)
    from autograder.cards import html_rendering

    html_rendering.templates()
    from autograder.judge import controlled_judge

    controlled_judge.import_judge()
    for line in sys.stdin.buffer:
        answers.write(msgspec.json.encode(_floor(msgspec.json.decode(line, type=Task))) + b"\n")
        answers.flush()


def _floor(task: Task) -> dict[str, Any]:
    """CPU seconds of a task's cells and of the judge's children; and by cell."""
    from autograder.judge.controlled_judge import JudgeProcess
    from autograder.judge.ros_setup import lease_domain

    group = CpuGroup.make()
    with HeldFolder("autograder-bench-") as held, lease_domain() as domain:
        folder = held.path
        reading, writing = os.pipe()
        with JudgeProcess(folder / "judge", seed=task.seed) as judge:
            # From here on, when it is warm, the judge counts.
            for child_process in psutil.Process().children(recursive=True):
                if group:
                    group.take(child_process.pid)
            began = time.monotonic()
            child = os.fork()
            if child == 0:
                _run(task, folder, domain, judge, group, writing)
            os.close(writing)
            with os.fdopen(reading, "rb") as result:
                cells = msgspec.json.decode(result.read() or b"[]")
            os.waitpid(child, 0)
            seconds = time.monotonic() - began
        cpu = group.seconds() if group else None
        if group:
            group.remove()
    return {"notebook": task.notebook, "seconds": seconds, "cpu": cpu, "cells": cells}


def _run(task: Task, folder: Path, domain: int, judge: Any, group: CpuGroup | None, writing: int) -> None:
    """The child's whole life."""
    try:
        if group:
            group.join()
        work = folder / "work"
        work.mkdir()
        os.chdir(work)
        os.environ.update(
            {
                "ROS_DOMAIN_ID": str(domain),
                "AUTOGRADER_JUDGE_SOCKET": str(folder / "judge"),
                "HOME": str(folder),
            }
        )
        from IPython.core.interactiveshell import InteractiveShell

        shell: Any = InteractiveShell.instance()
        spent = []
        sink = io.StringIO()
        with contextlib.redirect_stdout(sink):
            for cell in task.cells:
                if cell.kind is not CellType.CODE:
                    continue
                before, began = group.seconds() if group else 0.0, time.monotonic()
                exercise = cell.check.exercise if cell.check else ""
                if exercise:
                    judge.open(exercise)
                shell.run_cell(cell.source, store_history=False)
                if exercise:
                    judge.close()
                cpu = (group.seconds() if group else 0.0) - before
                spent.append([cell.source[:40], time.monotonic() - began, cpu, exercise])
        os.write(writing, msgspec.json.encode(spent))
    finally:
        os._exit(0)


if __name__ == "__main__":
    main()
