"""docs/first-exercise.md, done step by step in a course that has no other exercise."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from autograder.authoring.new_exercise import EXAMPLES

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs/first-exercise.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(console|toml|python)\n(.*?)^```", re.MULTILINE | re.DOTALL)
TABLE = "solutions/02_mine/lab_8_1/battery.answers/wrong/answers.toml"
NUMBERED = re.compile(r"^ +\d+/\d+ ")
"""Which answer is judged first depends on the machine."""


def run(course: Path, command: str) -> str:
    """Type a command of the page in a new shell; what it prints, errors included."""
    program = f"{sys.executable} -m autograder"
    done = subprocess.run(
        ["bash", "-c", command.replace("./course", program)],
        cwd=course,
        env=os.environ | {"AUTOGRADER_COURSE": str(course)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.stdout


def test_the_page_takes_a_page_and_shows_the_exercise_as_it_is() -> None:
    assert len(PAGE.splitlines()) <= 120
    shown = next(text for kind, text in BLOCK.findall(PAGE) if kind == "python")
    example = (EXAMPLES / "solutions/recipes/publisher/battery.py").read_text(encoding="utf-8")
    assert shown in example.replace("publisher.battery", "lab_8_1.battery")


@pytest.mark.ros
@pytest.mark.slow
def test_the_page_does_what_it_says(tmp_path: Path) -> None:
    (tmp_path / "solutions").mkdir()
    for kind, text in BLOCK.findall(PAGE):
        if kind == "toml":
            with (tmp_path / TABLE).open("a", encoding="utf-8") as table:
                table.write(f"\n{text}")
        for step in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:] if kind == "console" else ():
            command, *shown = step.splitlines()
            printed = run(tmp_path, command)
            for line in shown:
                assert NUMBERED.sub("", line) in printed, f"{command}\n{printed}"
