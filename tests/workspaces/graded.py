"""A judge with a grader's side: sources come from a notebook, and are built and run there."""

from __future__ import annotations

import contextlib
import socket
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.judge.controlled_judge import JudgeProcess
from autograder.judge.ros_setup import subject_environment
from autograder.messages.json_lines import Lines
from autograder.messages.judge_messages import Check, Collect, Judged
from autograder.notebook.checking.subject_runs import send_sources
from autograder.workspaces.grading_service import ServiceSockets, WorkspaceService
from autograder.workspaces.jobs import PlainJobs

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.verdict import Verdict


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
