"""A command ends when it is told to, also where its wait for ROS is not woken."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from course_runtime.ros2_command.commands import TERMINATED

NEVER_WOKEN = """
import threading
from course_runtime.ros2_command.graph_node import graph_node
with graph_node():
    print("waits", flush=True)
    threading.Event().wait()
"""


@pytest.mark.ros
def test_sigterm_ends_a_wait_that_nothing_wakes() -> None:
    root = Path(__file__).resolve().parents[3]
    with subprocess.Popen(
        [sys.executable, "-c", NEVER_WOKEN], cwd=root, stdout=subprocess.PIPE, text=True
    ) as running:
        try:
            assert running.stdout is not None
            assert running.stdout.readline() == "waits\n"
            running.terminate()
            assert running.wait(60) == TERMINATED
        finally:
            running.kill()
