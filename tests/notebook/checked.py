"""One check of a function in this process, by a judge in a process of its own that a test may have changed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.judge.controlled_judge import JudgeProcess
from autograder.messages.judge_messages import SOCKET_VARIABLE
from autograder.notebook.checking.check import check

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.verdict import Diagnosis, Verdict

Checked = Callable[[str, object], "Verdict"]
"""Checks a subject by an exercise."""
Diagnosed = Callable[[str, object], "Diagnosis"]
_JUDGE = """
import runpy, sys
from autograder.judge import ros_setup
ros_setup.prepare_judge()
{change}
sys.argv = ["judge", "--attached", sys.argv[1], sys.argv[2]]
runpy.run_module("autograder.judge", run_name="__main__")
"""


class _Changed:
    """A judge's process that first runs a few lines of a test's."""

    def __init__(self, change: str, listener: int, orders: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", _JUDGE.format(change=change), str(listener), str(orders)],
            stdin=subprocess.DEVNULL,
            pass_fds=(listener, orders),
            start_new_session=True,
        )

    def end(self) -> None:
        """End it with all that it has forked."""
        with suppress(ProcessLookupError):  # it has ended by itself
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()


@contextmanager
def a_judge(*, seed: str = "a test", change: str = "") -> Iterator[Checked]:
    """A judge for several checks of functions of this process.

    Args:
        seed: What the random inputs are drawn from.
        change: Python that the judge's process runs before it serves.

    Yields:
        A function that checks a subject, and gives the verdict that the judge hands to a grader.
    """
    with tempfile.TemporaryDirectory(prefix="judge-") as folder:
        path = Path(folder) / "judge.socket"
        with JudgeProcess(path, seed=seed, start=lambda one, two: _Changed(change, one, two)) as judge:

            def checked(exercise: str, subject: object) -> Verdict:
                judge.open(exercise)
                with pytest.MonkeyPatch.context() as patch:
                    patch.setenv(SOCKET_VARIABLE, str(path))
                    check(exercise, subject)
                verdict = judge.close().verdict
                assert verdict is not None
                return verdict

            yield checked
