"""Answers of the bank, judged as a grader judges them: sources from a notebook, built and run by the grader's side.

By hand: ``python tests/workspaces/graded.py lab_1_1.hello`` judges all answers with that in their names, without boxes.
"""

from __future__ import annotations

import contextlib
import socket
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder.authoring.answer_bank import Answer, answers
from autograder.judge.controlled_judge import JudgeProcess
from autograder.judge.ros_setup import subject_environment
from autograder.messages.json_lines import Lines
from autograder.messages.judge_messages import Check, Collect, Judged
from autograder.notebook.checking.subject_runs import send_sources
from autograder.workspaces.grading_service import ServiceSockets, WorkspaceService
from autograder.workspaces.jobs import PlainJobs
from tests.tiers import BUILT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.verdict import Verdict


def gradable() -> list[Answer]:
    """The answers that hand in a path, not a command."""
    return [answer for answer in answers() if answer.exercise in BUILT and len(answer.command) == 1]


@contextlib.contextmanager
def graders_judge(folder: Path) -> Iterator[JudgeProcess]:
    """A judge with a socket of a grader's side that has no boxes.

    Args:
        folder: For the cache of builds.
    """
    builds = folder / "builds"
    builds.mkdir(mode=0o700, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        sockets = ServiceSockets(Path(name) / "j", Path(name) / "n")
        jobs = PlainJobs(subject_environment(0), handed_in=True)
        with (
            WorkspaceService(sockets, jobs, builds, {}, folder),
            JudgeProcess(Path(name) / "s", seed="graded") as judge,
        ):
            judge.workspaces = str(sockets.judge)
            yield judge


def judged(judge: JudgeProcess, exercise: str, path: Path) -> Verdict:
    """Hand a path in as a notebook does; what the judge tells its grader.

    Raises:
        RuntimeError: The judge has no verdict.
    """
    judge.open(exercise)
    connection = socket.socket(socket.AF_UNIX)
    connection.connect(str(judge.socket_path))
    kernel = Lines(connection)
    kernel.say(Check(exercise))
    kernel.hear(Collect)
    send_sources(kernel.say, path)
    kernel.hear(Judged)
    report = judge.close()
    if report.verdict is None:
        raise RuntimeError(report.trouble or "the judge has no verdict")
    return report.verdict


def judged_answer(judge: JudgeProcess, answer: Answer) -> Verdict:
    """Judge an answer of the bank."""
    with tempfile.TemporaryDirectory(prefix="answer-") as folder:
        (path,) = answer.unpack(Path(folder))
        with contextlib.chdir(folder):
            return judged(judge, answer.exercise, Path(path))


def main(wanted: list[str]) -> int:
    """Judge answers, print what is not as expected."""
    objections: list[Any] = []
    with tempfile.TemporaryDirectory() as folder, graders_judge(Path(folder)) as judge:
        for answer in gradable():
            if any(word in answer.name for word in wanted):
                began = time.monotonic()
                objection = answer.objection(judged_answer(judge, answer))
                objections += [objection] * bool(objection)
                print(
                    f"{answer.name}: {objection or 'as expected'} ({time.monotonic() - began:.1f} s)",
                    flush=True,
                )
    return 1 if objections else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or [""]))
