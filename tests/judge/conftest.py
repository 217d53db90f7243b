"""The bank is judged in a process of its own, many answers at once: most of its time is waiting."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.verdict import Verdict, from_json
from tests.tiers import asked_for

if TYPE_CHECKING:
    from collections.abc import Iterator

JOBS = 14
"""Answers that are judged at once while other tests run: most of them wait most of the time."""


@pytest.fixture(scope="session")
def verdicts(request: pytest.FixtureRequest) -> Iterator[dict[str, Verdict]]:
    """The verdicts on all answers that this session asks for."""
    names = [answer.name for answer in asked_for(request, "answer")]
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.measure", "bank", "--lines", "--jobs", str(JOBS), *names],
        cwd=Path(__file__).parents[2],
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # Tests of notebooks switch the checks of message fields on; a terminal has them off.
        env={name: value for name, value in os.environ.items() if name != "ROS_PYTHON_CHECK_FIELDS"},
    )
    try:
        lines, _ = process.communicate()
        assert process.returncode == 0, "the bank could not be judged; its error stands above"
        yield {
            name: from_json(verdict) for name, verdict in (line.split(" ", 1) for line in lines.splitlines())
        }
    finally:
        # Also when somebody presses Ctrl-C.
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
