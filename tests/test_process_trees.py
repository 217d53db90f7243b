from __future__ import annotations

import os
import signal
import subprocess
import sys

import psutil
import pytest

from autograder.process_trees import end_each, kill, known
from tests.cases import cases

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only Linux has it")

CHILD = """
import os, signal, subprocess, sys
from autograder.process_trees import die_with_parent
own, number = os.getpid(), getattr(signal, sys.argv[1])
command = ["sh", "-c", "trap 'echo told; exit' TERM; echo $$; while :; do sleep 0.1; done"]
subprocess.Popen(command, preexec_fn=lambda: die_with_parent(own, number))
signal.pause()
"""
LATE = """
import os, sys
from autograder.process_trees import die_with_parent
if os.fork() == 0:
    die_with_parent(1 << 30)
    print("alive")
os.wait()
"""


@pytest.mark.parametrize(("number", "said"), [("SIGKILL", b""), ("SIGTERM", b"told\n")])
def test_a_process_ends_with_its_parent_however_that_ends(number: str, said: bytes) -> None:
    with subprocess.Popen([sys.executable, "-c", CHILD, number], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        child = psutil.Process(int(parent.stdout.readline()))  # said by the shell once it has its trap
        parent.send_signal(signal.SIGKILL)
        psutil.wait_procs([child], timeout=60)
        assert not child.is_running()
        assert parent.stdout.read() == said


def test_a_parent_that_has_ended_already_is_noticed() -> None:
    done = subprocess.run([sys.executable, "-c", LATE], capture_output=True, text=True, check=False)
    assert done.stdout == ""


DAEMON = cases(__file__, "DAEMON")


def test_a_daemon_does_not_outlive_the_submission() -> None:
    result = subprocess.run(
        [sys.executable, "-c", DAEMON], capture_output=True, text=True, timeout=180, check=True
    )
    assert result.stdout.split() == ["1", "gone"]


def test_a_later_process_of_the_same_number_is_left_alone() -> None:
    with subprocess.Popen(["sleep", "600"]) as sleeper:
        kill({(sleeper.pid, "1"), (sleeper.pid, "")})
        assert sleeper.poll() is None
        kill(known([sleeper.pid]))
        assert sleeper.wait(60.0) == -signal.SIGKILL


def test_processes_that_are_ended_one_by_one_do_not_end_at_once() -> None:
    """Each waits a moment with its last line, and writes it whole before the next begins."""
    last_words = (
        "import os, signal, sys, time\n"
        "def leave(*_):\n    os.write(1, b'from ')\n    time.sleep(0.2)\n    os.write(1, b'one\\n')\n    os._exit(0)\n"
        "signal.signal(signal.SIGTERM, leave)\nos.write(2, b'.')\nwhile True:\n    time.sleep(0.01)"
    )
    reading, writing = os.pipe()
    begun, beginning = os.pipe()
    words = [sys.executable, "-c", last_words]
    processes = [subprocess.Popen(words, stdout=writing, stderr=beginning) for _ in range(3)]
    for _ in processes:
        assert os.read(begun, 1) == b"."
    end_each([process.pid for process in processes], signal.SIGTERM, 60.0)
    assert [process.wait(60.0) for process in processes] == [0, 0, 0]
    assert os.read(reading, 1000) == b"from one\n" * 3
    for descriptor in (reading, writing, begun, beginning):
        os.close(descriptor)


MANY_FILES = cases(__file__, "MANY_FILES")


def test_who_has_many_files_open_can_end_a_process() -> None:
    done = subprocess.run(
        [sys.executable, "-c", MANY_FILES], capture_output=True, text=True, timeout=180, check=True
    )
    assert done.stdout.split() == ["-9"]


ENTERED = cases(__file__, "ENTERED")
UNSHARE = ("unshare", "--user", "--map-root-user", "--pid", "--fork")


def test_the_first_process_of_a_box_ends_though_others_were_started_into_it_from_outside() -> None:
    if subprocess.run([*UNSHARE, "true"], capture_output=True, check=False).returncode != 0:
        pytest.skip("no namespaces are possible here")
    program = f"UNSHARE = {UNSHARE}\n{ENTERED}"
    done = subprocess.run([sys.executable, "-c", program], timeout=60, check=False)
    assert done.returncode == 0
