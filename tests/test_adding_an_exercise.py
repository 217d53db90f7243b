"""docs/adding-an-exercise.md, done step by step in a course that holds nothing else."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from autograder.authoring.new_exercise import EXAMPLES, recipes

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs/adding-an-exercise.md").read_text(encoding="utf-8")
COMMAND = re.compile(r"^\$ \./course (.+)$", re.MULTILINE)
EXERCISE = "lab_8_1.converter"
WRITTEN = re.compile(r"^written .*$", re.MULTILINE)


def run(course: Path, words: str) -> subprocess.CompletedProcess[str]:
    """Run a command of the page; its `./course` is this with the set-up done."""
    return subprocess.run(
        [sys.executable, "-m", "autograder", *words.split()],
        cwd=course,
        env=os.environ | {"AUTOGRADER_COURSE": str(course)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_page_names_every_recipe_and_is_short() -> None:
    assert [name for name in recipes() if f"`{name}`" not in PAGE] == []
    assert len(PAGE.splitlines()) <= 140


def test_the_page_shows_the_exercise_that_its_command_writes() -> None:
    (making, *_) = COMMAND.findall(PAGE)
    example = EXAMPLES / "solutions/recipes" / making.split()[-1] / f"{EXERCISE.partition('.')[2]}.py"
    assert example.is_file()
    assert f"(../{example.relative_to(ROOT)})" in PAGE


@pytest.mark.ros
@pytest.mark.slow
def test_the_page_does_what_it_says(tmp_path: Path) -> None:
    (tmp_path / "solutions/02_bridging_python_agents").mkdir(parents=True)
    (tmp_path / "solutions/02_bridging_python_agents/chapter.toml").write_text('title = "First"\n')
    making, trying, building = COMMAND.findall(PAGE)
    made = run(tmp_path, making)
    assert made.returncode == 0, made.stderr
    folder = tmp_path / "solutions/02_bridging_python_agents/lab_8_1"
    for name in re.findall(r"^\| `([^`]+)` \|", PAGE, re.MULTILINE):
        assert (folder / name).exists(), name
    tried = run(tmp_path, trying)
    assert tried.returncode == 0, tried.stdout + tried.stderr
    shown = PAGE.partition(f"$ ./course {trying}\n")[2].partition("```")[0].splitlines()
    for line in shown:
        # Which answer is judged first depends on the machine.
        assert line.partition("/17 ")[2] in tried.stdout, line
    built = run(tmp_path, building)
    assert WRITTEN.search(built.stdout), built.stdout + built.stderr
    assert {line.rstrip() for line in WRITTEN.findall(built.stdout)} <= set(PAGE.splitlines())
    recorded = run(tmp_path, f"record {EXERCISE}")
    assert recorded.stdout.startswith(f"{EXERCISE}: unchanged\n"), recorded.stdout + recorded.stderr
