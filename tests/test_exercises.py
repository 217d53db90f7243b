"""A file that is no exercise, as one is while its author writes it, is a sentence and disturbs no other exercise."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from autograder import exercises
from autograder.authoring.new_exercise import new_exercise

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


def test_a_ticket_is_two_exercises_and_one_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    new_exercise(tmp_path, "bugs_9.battery", "repair", chapter="01_first")
    assert [line.split()[0] for line in run(tmp_path, "check").stdout.splitlines()] == [
        "bugs_9.battery",
        "bugs_9.battery_why",
    ]
    (tmp_path / "solutions/01_first/bugs_9/battery.ticket.toml").write_text('title = "Too short"\n')
    done = run(tmp_path, "try-exercise", "bugs_9.battery")
    assert done.returncode == 2, done.stdout + done.stderr
    assert "battery.ticket.toml: Object missing required field `task`" in done.stderr
    assert "Traceback" not in done.stderr


def test_what_was_loaded_needs_no_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """A judge loads all exercises, and enters its box, which sees none of their files."""
    before = exercises.unbroken()
    monkeypatch.setattr(Path, "exists", lambda _: False)
    assert exercises.unbroken() == before
    assert len(before) == len(exercises.all_ids())


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
