"""``autograder grade`` on a class, as a person starts it."""

from __future__ import annotations

import statistics
import subprocess
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import msgspec

from benchmarks.machine import Usage, Watch
from benchmarks.stock import Points, points_in
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from benchmarks.classes import BenchmarkClass

GRADE = tuple(python_child("-m", "autograder", "grade").command)


@dataclass(frozen=True)
class OurRun:
    """The costs of ``autograder grade`` for a class.

    Attributes:
        notebooks: How many it executed.
        report: What it said of itself, as ``--json`` has it.
        usage: The machine meanwhile.
        busy_working: Share of all cores that was busy between the first and the last notebook, 0 to 1.
        points: What the gradebook says.
    """

    notebooks: int
    report: dict[str, object]
    usage: Usage
    busy_working: float
    points: Points


def run_ours(made: BenchmarkClass, log: Path) -> OurRun:
    """Grade a class and watch.

    Args:
        made: The class.
        log: Where standard error goes.

    Raises:
        RuntimeError: It could not be graded.
    """
    with Watch() as watch, log.open("wb") as errors:
        done = subprocess.run(
            [*GRADE, str(made.path), "--json"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=errors,
            preexec_fn=watch.prepare,
            check=False,
        )
    assert watch.usage is not None
    if done.returncode not in (0, 2) or not done.stdout:
        raise RuntimeError(f"autograder grade failed; see {log}")
    report = msgspec.json.decode(done.stdout)
    return OurRun(
        notebooks=int(report["totals"]["executed"]),
        report=report,
        usage=watch.usage,
        busy_working=_while_working(watch.busy_by_second, report),
        points=points_in(made.path, made.assignments, made.students),
    )


def _while_working(busy: Sequence[float], report: dict[str, object]) -> float:
    """The mean over the seconds from the first notebook's start to the last one's end."""
    timings = msgspec.convert(report["timings"], dict[str, float])
    first, last = timings["first_started"], timings["last_ended"]
    inside = busy[int(first) : max(int(first) + 1, int(last))]
    return statistics.fmean(inside) if inside else 0.0


def problems_of(run: OurRun) -> list[str]:
    """Return the problems that the run itself reported."""
    return msgspec.convert(run.report["problems"], list[str])


def diagnosed(run: OurRun, student: str, assignment: str) -> str:
    """Return the judge's verdicts on a submission, as keys and texts."""
    submissions = msgspec.convert(run.report["submissions"], list[dict[str, Any]])
    return "; ".join(
        f"{exercise['exercise']} {exercise['state']} {exercise['diagnosis']}: {exercise['reason']}"
        for one in submissions
        if (one["student"], one["assignment"]) == (student, assignment)
        for exercise in one["exercises"]
        if exercise["score"] != exercise["max_score"]
    )
