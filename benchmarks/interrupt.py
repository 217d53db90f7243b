"""Ctrl-C in the middle of a grading run: how long until the command has ended, and whether it goes on from there."""

from __future__ import annotations

import re  # noqa: TID251  (not what a student handed in)
import signal
import subprocess
import time
from typing import TYPE_CHECKING

from benchmarks.ours import GRADE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from benchmarks.classes import BenchmarkClass

STOPPED = 130
"""The exit code of a command that Ctrl-C has ended (128 + SIGINT, as shells have it)."""
_GRADED = re.compile(r"graded \d+ of \d+")


def measure_interrupts(made: BenchmarkClass, after: Sequence[int]) -> list[float]:
    """Seconds from Ctrl-C to the end of ``autograder grade``; each run continues the stopped one.

    Args:
        made: The class; it has to last for all turns.
        after: For each turn, how many notebooks are graded before Ctrl-C.

    Raises:
        RuntimeError: It ended otherwise.
    """
    return [_interrupted(made, count) for count in after]


def _interrupted(made: BenchmarkClass, after: int) -> float:
    process = subprocess.Popen(
        [*GRADE, str(made.path)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        # If this program was started in the background, it would ignore Ctrl-C, and so would its children.
        preexec_fn=_hear_interrupts,
    )
    assert process.stderr is not None
    seen = 0
    while seen < after and (line := process.stderr.readline()):
        seen += bool(_GRADED.match(line))
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, said = process.communicate()
    if process.returncode != STOPPED:
        raise RuntimeError(f"after Ctrl-C, autograder grade ended with {process.returncode}: {said[-300:]}")
    return time.monotonic() - began


def _hear_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
