"""The bank is judged beside the other tests: most of its time is waiting, and its verdicts do not mind company."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import IO, NamedTuple

import pytest

from autograder.verdict import Verdict, from_json

JOBS = 8
"""Answers that are judged at once while other tests run: most of them wait most of the time."""


class BankRun(NamedTuple):
    """The process that judges, and what it prints."""

    process: subprocess.Popen[str]
    output: IO[str]


_RUN = pytest.StashKey[BankRun]()


def _asks_for_verdicts(item: pytest.Item) -> bool:
    return "verdicts" in getattr(item, "fixturenames", ())


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Ask for the bank's verdicts last."""
    items.sort(key=_asks_for_verdicts)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Begin to judge what this session will ask for."""
    asking = [item for item in session.items if _asks_for_verdicts(item)]
    if not asking or session.config.option.collectonly:
        return
    names = [getattr(item, "callspec").params["answer"].name for item in asking]  # noqa: B009  (untyped in pytest)
    output = tempfile.TemporaryFile("w+", encoding="utf-8")  # noqa: SIM115  (read at the end of the session)
    program = Path(__file__).with_name("bank.py")
    process = subprocess.Popen(
        [sys.executable, str(program), "--lines", "--warm", "--jobs", str(JOBS), *names],
        stdout=output,
        text=True,
        start_new_session=True,
        # Tests of notebooks switch the checks of message fields on; a terminal has them off.
        env={name: value for name, value in os.environ.items() if name != "ROS_PYTHON_CHECK_FIELDS"},
    )
    session.config.stash[_RUN] = BankRun(process, output)


def pytest_unconfigure(config: pytest.Config) -> None:
    """Leave nothing running."""
    run = config.stash.get(_RUN, None)
    if run is not None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(run.process.pid, signal.SIGKILL)
        run.process.wait()
        run.output.close()


@pytest.fixture(scope="session")
def verdicts(request: pytest.FixtureRequest) -> dict[str, Verdict]:
    """The verdicts on all answers that this session asks for."""
    run = request.config.stash[_RUN]
    assert run.process.wait() == 0, "the bank could not be judged; its error stands above"
    run.output.seek(0)
    pairs = (line.split(" ", 1) for line in run.output)
    return {name: from_json(verdict) for name, verdict in pairs}
