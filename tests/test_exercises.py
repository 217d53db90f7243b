"""A file that is no exercise, as one is while its author writes it, is a sentence and disturbs no other exercise."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from autograder.authoring.new_exercise import new_exercise

if TYPE_CHECKING:
    from pathlib import Path

WHOLE, BROKEN = "lab_9_1.battery", "lab_9_2.battery"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A course with two labs, of which the second one's exercise cannot be imported."""
    for exercise_id in (WHOLE, BROKEN):
        new_exercise(tmp_path, exercise_id, "publisher", chapter="01_first")
    (tmp_path / "solutions/01_first/lab_9_2/battery.py").write_text("x = 1\ndef broken(:\n")
    return tmp_path


def run(root: Path, *words: str) -> subprocess.CompletedProcess[str]:
    environ = os.environ | {"AUTOGRADER_COURSE": str(root)}
    return subprocess.run(
        [sys.executable, "-m", "autograder", *words], env=environ, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize("words", [["try-exercise", BROKEN], ["record", BROKEN], ["check", BROKEN]])
def test_a_command_says_which_file_and_line_is_broken(root: Path, words: list[str]) -> None:
    done = run(root, *words)
    assert done.returncode == 2, done.stdout + done.stderr
    assert f"lab_9_2/battery.py cannot be imported: SyntaxError: invalid syntax ({root}" in done.stderr
    assert "line 2)" in done.stderr
    assert "Traceback" not in done.stderr


def test_no_notebook_is_built_of_its_lab(root: Path) -> None:
    done = run(root, "build")
    assert done.returncode == 2, done.stdout + done.stderr
    assert "lab_9_2/battery.py cannot be imported: SyntaxError" in done.stdout


def test_the_others_are_listed(root: Path) -> None:
    done = run(root, "check")
    assert [line.split()[0] for line in done.stdout.splitlines()] == [WHOLE]
    assert "cannot be imported" in done.stderr


@pytest.mark.ros
def test_a_notebooks_judge_answers_for_each_of_them(root: Path) -> None:
    address = root / "judge"
    judge = subprocess.Popen(
        [sys.executable, "-m", "autograder.judge", "--socket", str(address)],
        env=os.environ | {"AUTOGRADER_COURSE": str(root)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    with judge:
        assert judge.stdin
        assert judge.stdout
        assert judge.stdout.readline() == b"ready\n"
        assert "cannot be imported" in ask(address, BROKEN)["why"]
        assert ask(address, WHOLE)["say"] != "refused"
        judge.stdin.close()
        judge.stdout.read()


def ask(address: Path, exercise_id: str) -> dict[str, str]:
    """Ask for a check; the judge's first word."""
    with socket.socket(socket.AF_UNIX) as notebook:
        notebook.connect(str(address))
        notebook.sendall(json.dumps({"say": "check", "exercise": exercise_id}).encode() + b"\n")
        with notebook.makefile("rb") as lines:
            said: dict[str, str] = json.loads(lines.readline())
    return said
