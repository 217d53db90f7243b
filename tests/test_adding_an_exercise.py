"""docs/adding-an-exercise.md, done step by step in a course that holds nothing but what the page writes."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs/adding-an-exercise.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^(?P<fence>`{3,})\w+\n(?P<text>.*?)^(?P=fence)$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"(?:# |<!-- )(?P<name>[\w./]+/[\w.]+)(?: -->)?\n")
EXERCISE = "lab_9_1.battery"

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def files() -> dict[str, str]:
    """The files that the page writes: those of its blocks that begin with a name."""
    texts = [block["text"] for block in BLOCK.finditer(PAGE)]
    return {named["name"]: text[named.end() :] for text in texts if (named := NAMED.match(text))}


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package and the bank's program, with the page's files and its line in the list of modules."""
    root = tmp_path_factory.mktemp("course")
    shutil.copytree(ROOT / "autograder", root / "autograder", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "tests/judge", root / "tests/judge")
    for name, text in files().items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    listing = root / "autograder/exercises/__init__.py"
    line = re.search(r'^    "lab_9_1\.battery": .*,$', PAGE, re.MULTILINE)
    assert line is not None
    listing.write_text(
        re.sub(r"(?s)^_MODULES = \{.*?^\}", f"_MODULES = {{\n{line[0]}\n}}", listing.read_text(), flags=re.M)
    )
    return root


def run(course: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """Run Python in the course; the page's `./course` is this with the set-up done."""
    environ = os.environ | {"PYTHONPATH": str(course), "AUTOGRADER_COURSE": str(course)}
    return subprocess.run(
        [sys.executable, *command], cwd=course, env=environ, capture_output=True, text=True, check=False
    )


def test_the_page_does_what_it_says(course: Path) -> None:
    recorded = run(course, "-m", "autograder", "record", EXERCISE)
    assert recorded.returncode == 0, recorded.stderr
    assert recorded.stdout.strip() in PAGE
    again = run(course, "-m", "autograder", "record", EXERCISE)
    assert "unchanged" in again.stdout
    built = run(course, "-m", "autograder", "build")
    assert built.stdout.split()[:2] == ["written", "chapters/01_ros2_fundamentals/lab_9_1.ipynb"], (
        built.stdout
    )
    bank = run(course, "tests/judge/bank.py", "lab_9_1")
    assert bank.returncode == 0, bank.stdout + bank.stderr
    wrong = "tests/submissions/lab_9_1.battery/wrong/counter_step.py"
    checked = run(course, "-m", "autograder", "check", EXERCISE, "--", sys.executable, wrong)
    assert checked.returncode == 1
    assert "The charge goes up: 100, 101" in checked.stdout
    assert "4 of 10 points" in checked.stdout
