"""docs/first-exercise.md, done step by step in a course that has no other exercise."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.authoring.new_exercise import EXAMPLES

if TYPE_CHECKING:
    from collections.abc import Sequence

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs/first-exercise.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(console|toml|python)\n(.*?)^```", re.MULTILINE | re.DOTALL)
TABLE = "solutions/02_mine/lab_8_1/battery.answers/wrong/answers.toml"
NUMBERED = re.compile(r"^ +\d+/\d+ ")
"""Which answer is judged first depends on the machine."""


END = "-- end of a step --"


def typed(course: Path, steps: Sequence[str]) -> list[str]:
    """Type all steps into one shell, as a reader does; what each prints, errors included."""
    start = course / "course"
    start.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m autograder "$@"\n')
    start.chmod(0o755)
    done = subprocess.run(
        ["bash"],
        input="".join(f"{step}\necho '{END}'\n" for step in steps),
        cwd=course,
        env=os.environ | {"AUTOGRADER_COURSE": str(course)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.stdout.split(END)[:-1]


def test_the_page_takes_a_page_and_shows_the_exercise_as_it_is() -> None:
    assert len(PAGE.splitlines()) <= 120
    shown = next(text for kind, text in BLOCK.findall(PAGE) if kind == "python")
    example = (EXAMPLES / "solutions/recipes/publisher/battery.py").read_text(encoding="utf-8")
    assert shown in example.replace("publisher.battery", "lab_8_1.battery")


@pytest.mark.ros
@pytest.mark.slow
def test_the_page_does_what_it_says(tmp_path: Path) -> None:
    (tmp_path / "solutions").mkdir()
    steps: list[tuple[str, list[str]]] = []
    for kind, text in BLOCK.findall(PAGE):
        if kind == "toml":
            steps.append((f"cat >> {TABLE} <<'EOF'\n\n{text}EOF", []))
        elif kind == "console":
            lines = [step.splitlines() for step in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]]
            steps += [(command, shown) for command, *shown in lines]
    printed = typed(tmp_path, [command for command, _ in steps])
    assert len(printed) == len(steps)
    for (command, shown), said in zip(steps, printed, strict=True):
        for line in shown:
            assert NUMBERED.sub("", line) in said, f"{command}\n{said}"
