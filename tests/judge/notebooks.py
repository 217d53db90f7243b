"""A solution as a notebook has it, judged in forks: a program that ends with ``check(…)``, and a judge beside it."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.judge import controlled_judge
from autograder.judge.controlled_judge import JudgeDied, JudgeProcess
from autograder.judge.machine_fitness import TOO_BUSY
from autograder.judge.ros_setup import subject_environment
from autograder.judge.subject import LEFTOVERS, CommandSubject
from autograder.process_trees import end_descendants
from autograder.verdict import Diagnosis, failed, not_checked, to_json

if TYPE_CHECKING:
    from collections.abc import Sequence


NEVER_ASKED = "never_asked"
"""The diagnosis where the program came to its end before its check."""
SPARE = 10.0
"""Seconds beyond an exercise's limit before a program that does not end is ended."""


class _ForkedJudge:
    """A judge in a fork of this process, which has imported what a judge needs."""

    def __init__(self, listener: int, orders: int) -> None:
        self.pid = os.fork()
        if self.pid == 0:
            with contextlib.suppress(BaseException):
                os.setsid()
                mine = {0, 1, 2, listener, orders}
                for entry in Path("/proc/self/fd").iterdir():
                    if int(entry.name) not in mine:
                        with contextlib.suppress(OSError):
                            os.close(int(entry.name))
                controlled_judge.run({}, (listener, orders))
            os._exit(0)

    def end(self) -> None:
        """End it with all that it has forked."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            os.waitpid(self.pid, 0)


def verdict_in_notebook(exercise_id: str, file: Path, seed: str) -> bytes:
    """Run a program that ends with its check; what the judge tells a grader of it, as JSON.

    Must run in a fork without threads of a process that has imported what a judge needs.

    Args:
        exercise_id: The exercise's id.
        file: The program.
        seed: What random inputs are drawn from.
    """
    exercise = exercises.get(exercise_id)
    CommandSubject([])  # makes this process the one that gets the orphans
    judges: list[int] = []

    def start(listener: int, orders: int) -> _ForkedJudge:
        forked = _ForkedJudge(listener, orders)
        judges.append(forked.pid)
        return forked

    with tempfile.TemporaryDirectory(prefix="notebook-") as folder:
        try:
            with JudgeProcess(Path(folder) / "judge", seed=seed, start=start) as judge:
                judge.open(exercise.id)
                _run(file, judge.socket_path, exercise.limit + SPARE, judges)
                report = judge.close()
        except JudgeDied as error:
            return to_json(not_checked(exercise.id, exercise.title, exercise.points, str(error)))
    if report.crowded:
        return to_json(not_checked(exercise.id, exercise.title, exercise.points, TOO_BUSY))
    if report.trouble:
        return to_json(not_checked(exercise.id, exercise.title, exercise.points, report.trouble))
    never_asked = Diagnosis(NEVER_ASKED, "The program ended before its check.")
    return to_json(report.verdict or failed(exercise.id, exercise.title, exercise.points, never_asked))


def _run(file: Path, socket: Path, limit: float, judges: Sequence[int]) -> None:
    environment = subject_environment(0) | {"AUTOGRADER_JUDGE_SOCKET": str(socket)}
    nothing = subprocess.DEVNULL
    with subprocess.Popen(
        [sys.executable, str(file)],
        env=environment,
        cwd=file.parent,
        stdin=nothing,
        stdout=nothing,
        stderr=nothing,
        start_new_session=True,
    ) as program:
        with contextlib.suppress(subprocess.TimeoutExpired):
            program.wait(limit)
        program.kill()
    end_descendants(LEFTOVERS, spare=judges)
