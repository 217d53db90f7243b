"""The processes below a launch, some of which do not want to be looked at."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import pytest

from autograder.kit.output.launched_processes import PROCESS_MARK
from autograder.process_trees import descendants, kill, known
from autograder.workspaces import __main__ as workspaces_command
from autograder.workspaces import launch_watching
from autograder.workspaces.__main__ import print_line
from autograder.workspaces.launch_watching import watched
from autograder.workspaces.program_preparation import Prepared
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

RENAMES_ITSELF = cases(__file__, "RENAMES_ITSELF")


@pytest.mark.parametrize(("more", "most"), [("x" * 100_000, 2), ("x", 5)], ids=["long", "ever another"])
def test_what_renames_itself_all_the_time_fills_nobody_s_memory(
    monkeypatch: pytest.MonkeyPatch, more: str, most: int
) -> None:
    """Twenty of these, with command lines of 1.2 MB, took 80 MB of the grader's memory each second."""
    monkeypatch.setattr(launch_watching, "MAX_COMMAND_LINE", 2_000)
    monkeypatch.setattr(launch_watching, "MAX_COMMAND_LINES", 5)
    reported: list[str] = []
    starts_it = "import subprocess, sys; subprocess.run(sys.argv[1:])"
    with subprocess.Popen(
        [sys.executable, "-c", starts_it, sys.executable, "-c", RENAMES_ITSELF, more]
    ) as launch:
        try:
            with watched(launch.pid, reported.append):
                while not reported:
                    assert launch.poll() is None
                    time.sleep(0.05)
                time.sleep(1.0)
        finally:
            kill(known(descendants(launch.pid)))
    assert 1 <= len(reported) <= most
    assert max(map(len, reported)) < 3_000


def test_a_report_begins_a_line_where_the_launch_is_in_the_middle_of_one(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """`ros2 launch` writes a line and its end apart; the report between them was read by nobody, now and then."""
    os.mkfifo(tmp_path / "reported")
    told = os.open(tmp_path / "reported", os.O_RDWR)

    def report(line: str) -> None:
        print_line(line)
        os.write(told, b"\n")

    monkeypatch.setattr(workspaces_command, "print_line", report)
    middle = f"printf 'started'; head -n 1 {tmp_path / 'reported'}; true"
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        workspaces_command._run(Prepared(["sh", "-c", middle], dict(os.environ), {}))
    finally:
        os.close(told)
        for number, handler in before.items():
            signal.signal(number, handler)
    lines = capfd.readouterr().out.splitlines()
    assert any("head" in line for line in lines if line.startswith(PROCESS_MARK))
