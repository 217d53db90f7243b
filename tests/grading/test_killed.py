"""A grader killed at random moments: see ``kill_the_grader.py``, which kills it twenty times when run by itself."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from autograder.boxes.sandbox import why_impossible

PROGRAM = Path(__file__).parent / "kill_the_grader.py"


@pytest.mark.slow
def test_no_grade_is_wrong_or_lost_and_nothing_is_left() -> None:
    if reason := why_impossible():
        pytest.skip(reason)
    ended = subprocess.run(
        [sys.executable, "-W", "ignore", str(PROGRAM), "--kills", "4"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert ended.stdout.count("killed after") == 4
