"""`check --box` of a workspace or a launch file, typed in a folder without a course: as without a box."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from autograder import course, exercises
from autograder.authoring.answer_bank import answers_folder
from autograder.boxes.sandbox import why_impossible
from autograder.judge import command_check
from autograder.kit.evidence import Event, Part
from autograder.kit.output.workspace_reports import (
    WorkspaceReport,
    failed_line,
    runner_trouble,
    workspace_report_line,
)
from autograder.workspaces.__main__ import main
from tests.copies import copied
from tests.measure.bank import answer_named

pytestmark = [
    pytest.mark.ros,
    pytest.mark.skipif(bool(why_impossible()), reason=f"no boxes here: {why_impossible()}"),
]


def checked(folder: Path, exercise: str, *command: str) -> tuple[int, str, float]:
    """Check a path in a folder that has nothing of the course above it, and say how it ended."""
    done = subprocess.run(
        [sys.executable, "-m", "autograder", "check", exercise, "--box", "--json", "--", *command],
        capture_output=True, text=True, check=False, cwd=folder, env={**os.environ, "PYTHONSAFEPATH": "1"},
    )  # fmt: skip
    verdict = json.loads(done.stdout)
    return done.returncode, verdict["state"], verdict["score"]


def test_a_right_workspace_has_all_points(tmp_path: Path) -> None:
    copied(course.root() / "solutions" / "ros2_ws", tmp_path / "my ws")
    exercise = "lab_1_2.programs"
    assert checked(tmp_path, exercise, "my ws") == (0, "passed", exercises.get(exercise).points)


def test_a_right_launch_file_finds_the_courses_programs(tmp_path: Path) -> None:
    shutil.copy(answers_folder("exercise_1_1.remap") / "right/execute_process.launch.py", tmp_path)
    assert checked(tmp_path, "exercise_1_1.remap", "execute_process.launch.py")[:2] == (0, "passed")


@pytest.mark.slow
def test_a_right_interface_is_built_in_the_box(tmp_path: Path) -> None:
    *_, workspace = answer_named("lab_1_3.interface/right/as_in_the_lab.workspace").unpack(tmp_path)
    where = Path(workspace).relative_to(tmp_path) if Path(workspace).is_absolute() else workspace
    assert checked(tmp_path, "lab_1_3.interface", str(where))[:2] == (0, "passed")


def test_trouble_of_the_runner_is_no_verdict(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command_check, "runner_as_word", lambda _: '["NoSuchRunner", {}]')
    verdict, evidence = command_check.check_and_keep("lab_1_1.hello", [str(tmp_path)])
    assert (verdict.state, verdict.score, evidence) == ("not_checked", 0.0, b"")
    assert "Traceback" not in str(verdict)
    assert "NoSuchRunner" in str(verdict)


def test_the_runner_says_its_trouble_in_one_line(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["lab_9_9.none", str(tmp_path)]) == 2
    said = capfd.readouterr()
    assert said.err == ""
    assert runner_trouble([part(said.out.strip())]).startswith("UnknownExercise: no exercise is called")


def test_a_program_cannot_say_that_the_runner_failed() -> None:
    """A build has been reported before any program runs."""
    built = workspace_report_line(WorkspaceReport("built", built=True))
    assert runner_trouble([part(built, failed_line(ValueError("forged")))]) == ""
    assert runner_trouble([part(built), part(failed_line(ValueError("true")))]) == "ValueError: true"


def part(*lines: str) -> Part:
    return Part("a run", {}, [Event(0.1, "output", "stdout", {"text": line}) for line in lines])
