"""``autograder execute`` against the longest notebook in it."""

from __future__ import annotations

import re  # noqa: TID251  (not what a student handed in)
import subprocess
import time
from dataclasses import dataclass

from benchmarks.ours import AUTOGRADER

_LINE = re.compile(r"executed \d+ of \d+: (?P<name>.+?) \((?P<seconds>[\d.]+) s\)")


@dataclass(frozen=True)
class ExecuteRun:
    """One run of the command.

    Attributes:
        seconds: Wall time.
        longest: Wall time of the longest notebook.
        name: Which that was.
        notebooks: How many there were.
    """

    seconds: float
    longest: float
    name: str
    notebooks: int


def measure_execute(only: tuple[str, ...] = ()) -> ExecuteRun:
    """Run the command.

    Args:
        only: Names of notebooks; all where empty.
    """
    began = time.monotonic()
    done = subprocess.run([*AUTOGRADER, "execute", *only], capture_output=True, text=True, check=False)
    seconds = time.monotonic() - began
    if done.returncode:
        raise RuntimeError(
            f"autograder execute found something wrong, so its time is no figure: {done.stderr[-400:]}"
        )
    times = {match["name"]: float(match["seconds"]) for match in _LINE.finditer(done.stderr)}
    if not times:
        raise RuntimeError(f"autograder execute said nothing of its notebooks: {done.stderr[-400:]}")
    name = max(times, key=lambda key: times[key])
    return ExecuteRun(seconds, times[name], name, len(times))
