"""Ctrl-C, TERM and a crash of a command end everything that it has started."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from autograder import course

sys.path.insert(0, str(Path(__file__).parent / "grading"))
from tiny_class import TinyClass, make_tiny_class

pytestmark = [
    pytest.mark.ros,
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="only Linux adopts orphans"),
]
PROGRAM = """
import subprocess, time
subprocess.Popen(["sleep", "7656.5"], start_new_session=True)
time.sleep(600)
"""
COURSE = [sys.executable, "-m", "autograder"]
# As the shell of `./course test` waits for pytest.
TESTS = f"{sys.executable} -m tests.nothing_left {sys.executable} -m pytest --numprocesses 1 {{folder}}; true"
COMMANDS = {
    "check": (
        "sleep 7656.5",
        [*COURSE, "check", "lab_1_2.talker", "--", sys.executable, "{folder}/program.py"],
    ),
    "grade": ("running.order_executor", [*COURSE, "grade", "{folder}/tiny-class"]),
    "execute": ("running.order_executor", [*COURSE, "execute", "lab_1_2"]),
    "test": ("sleep 7656.5", ["sh", "-c", TESTS]),
    "bank": (
        "talker.answers",
        [sys.executable, "-m", "tests.measure", "bank", "lab_1_2.talker"],
    ),
}
"""By name: what the command line of a process has that shows that it is in its middle, and how it is called."""


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("ending", ["SIGINT", "SIGTERM", "SIGKILL"])
def test_everything_ends_with_the_command(name: str, ending: str, tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "test_program.py").write_text(f"def test_it():{PROGRAM.replace(chr(10), chr(10) + '    ')}")
    if name == "grade":
        TinyClass(make_tiny_class(tmp_path)).submit("ada")
    word, command = COMMANDS[name]
    words = [part.replace("{folder}", str(tmp_path)) for part in command]
    done = subprocess.run(
        [sys.executable, "-m", "tests.left_behind", ending, word, *words],
        cwd=course.root(),
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_a_run_of_tests_leaves_no_temporary_files(tmp_path: Path) -> None:
    makes_one_and_is_killed = "import os, tempfile; tempfile.mkdtemp(); os.kill(os.getpid(), 9)"
    done = subprocess.run(
        [sys.executable, "-m", "tests.nothing_left", sys.executable, "-c", makes_one_and_is_killed],
        cwd=course.root(),
        env={**os.environ, "TMPDIR": str(tmp_path)},
        check=False,
    )
    assert done.returncode == 128 + 9
    assert list(tmp_path.iterdir()) == []
