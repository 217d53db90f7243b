from __future__ import annotations

import signal
import subprocess
import sys
import time

import psutil
import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only Linux has it")

CHILD = """
import os, signal, subprocess, sys
from autograder.parent_death import die_with_parent
own, number = os.getpid(), getattr(signal, sys.argv[1])
command = ["sh", "-c", "trap 'echo told; exit' TERM; while :; do sleep 0.1; done"]
child = subprocess.Popen(command, preexec_fn=lambda: die_with_parent(own, number))
print(child.pid, flush=True)
signal.pause()
"""
LATE = """
import os, sys
from autograder.parent_death import die_with_parent
if os.fork() == 0:
    die_with_parent(1 << 30)
    print("alive")
os.wait()
"""


@pytest.mark.parametrize(("number", "said"), [("SIGKILL", b""), ("SIGTERM", b"told\n")])
def test_a_process_ends_with_its_parent_however_that_ends(number: str, said: bytes) -> None:
    with subprocess.Popen([sys.executable, "-c", CHILD, number], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        child = psutil.Process(int(parent.stdout.readline()))
        time.sleep(0.2)  # until the shell has its trap
        parent.send_signal(signal.SIGKILL)
        psutil.wait_procs([child], timeout=60)
        assert not child.is_running()
        assert parent.stdout.read() == said


def test_a_parent_that_has_ended_already_is_noticed() -> None:
    done = subprocess.run([sys.executable, "-c", LATE], capture_output=True, text=True, check=False)
    assert done.stdout == ""
