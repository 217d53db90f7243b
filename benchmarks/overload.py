"""Verdicts on a machine that is asked for far too much: slow must never mean wrong."""

from __future__ import annotations

import multiprocessing
import os
from typing import TYPE_CHECKING, Any

import msgspec

from benchmarks.ours import OurRun, run_ours

if TYPE_CHECKING:
    from pathlib import Path

    from benchmarks.classes import BenchmarkClass

TIMES_CORES = 4
BUSY_LOOPS = 2

Verdicts = dict[tuple[str, str], tuple[float, str, str]]
"""Score, state and diagnosis, by student and exercise."""


def run_overloaded(made: BenchmarkClass, log: Path) -> OurRun:
    """Grade a class again with four times as many boxes as cores, and two busy loops at the same time."""
    loops = [multiprocessing.Process(target=_busy, daemon=True) for _ in range(BUSY_LOOPS)]
    for loop in loops:
        loop.start()
    try:
        return run_ours(made, log, "--again", "--jobs", str(TIMES_CORES * (os.cpu_count() or 1)))
    finally:
        for loop in loops:
            loop.terminate()
            loop.join()


def verdicts_of(run: OurRun) -> Verdicts:
    """What a run found."""
    submissions = msgspec.convert(run.report["submissions"], list[dict[str, Any]])
    return {
        (one["student"], exercise["exercise"]): (
            exercise["score"],
            exercise["state"],
            exercise["diagnosis"],
        )
        for one in submissions
        for exercise in one["exercises"]
    }


def differences(calm: Verdicts, loaded: Verdicts) -> list[str]:
    """Each verdict that is not the same in both, in words."""
    return [
        f"{student} {exercise}: {calm[student, exercise]} calm, {loaded.get((student, exercise))} under load"
        for student, exercise in sorted(calm)
        if calm[student, exercise] != loaded.get((student, exercise))
    ]


def _busy() -> None:
    while True:
        pass
