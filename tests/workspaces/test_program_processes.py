"""The processes below a launch, some of which do not want to be looked at."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

from autograder.kit.runners import PROCESS_MARK
from autograder.process_trees import descendants, kill, known
from autograder.workspaces import program_processes
from autograder.workspaces.__main__ import _run
from autograder.workspaces.program_preparation import Prepared
from autograder.workspaces.program_processes import watched

RENAMES_ITSELF = """
import ctypes, time
words = open("/proc/self/stat").read().rpartition(")")[2].split()
end = int(words[46])  # arg_end of proc(5), counted from the state
for number in range(10**9):
    ctypes.memmove(end - 20, b"%018d" % number, 18)
    time.sleep(0.01)
"""


@pytest.mark.parametrize(("more", "most"), [("x" * 100_000, 2), ("x", 5)], ids=["long", "ever another"])
def test_what_renames_itself_all_the_time_fills_nobody_s_memory(
    monkeypatch: pytest.MonkeyPatch, more: str, most: int
) -> None:
    """Twenty of these, with command lines of 1.2 MB, took 80 MB of the grader's memory each second."""
    monkeypatch.setattr(program_processes, "MAX_COMMAND_LINE", 2_000)
    monkeypatch.setattr(program_processes, "MAX_COMMAND_LINES", 5)
    reported: list[str] = []
    starts_it = "import subprocess, sys; subprocess.run(sys.argv[1:])"
    with subprocess.Popen(
        [sys.executable, "-c", starts_it, sys.executable, "-c", RENAMES_ITSELF, more]
    ) as launch:
        try:
            with watched(launch.pid, reported.append):
                deadline = time.monotonic() + 20
                while not reported and time.monotonic() < deadline:
                    time.sleep(0.05)
                time.sleep(1.0)
        finally:
            kill(known(descendants(launch.pid)))
    assert 1 <= len(reported) <= most
    assert max(map(len, reported)) < 3_000


def test_a_report_begins_a_line_where_the_launch_is_in_the_middle_of_one(
    capfd: pytest.CaptureFixture[str],
) -> None:
    """`ros2 launch` writes a line and its end apart; the report between them was read by nobody, now and then."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        _run(Prepared(["sh", "-c", "printf 'started'; sleep 1; echo"], dict(os.environ), {}))
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    lines = capfd.readouterr().out.splitlines()
    assert any("sleep" in line for line in lines if line.startswith(PROCESS_MARK))
