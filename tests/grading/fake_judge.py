"""A judge without ROS for tests of everything around it.

The check of the tiny class writes down a number beside the judge's socket; this judge reads it and gives that
score. It lives in the worker process, so tests name it as ``fake_judge:FakeJudge`` with this folder on
PYTHONPATH.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Self

from autograder.judge.protocol import Report
from autograder.verdict import Diagnosis, State, Verdict

if TYPE_CHECKING:
    from pathlib import Path


class FakeJudge:
    def __init__(self, socket_path: Path, *, seed: str) -> None:
        self._said = socket_path.with_suffix(".said")
        self._seed = seed
        self._exercise = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def open(self, exercise_id: str) -> None:
        self._exercise = exercise_id
        self._said.unlink(missing_ok=True)

    def close_report(self) -> Report:
        if not self._said.exists():
            return Report()
        said = self._said.read_text()
        if said == "die":
            raise RuntimeError("the judge is gone")
        if said == "kill worker":
            os._exit(9)
        return Report(verdict(self._exercise, float(said), self._seed))


def verdict(exercise: str, score: float, seed: str = "") -> Verdict:
    """Passed at 10 points, failed with a diagnosis below."""
    diagnosis = (
        None if score == 10 else Diagnosis("wrong_text", "It says something else.", "Say the right thing.")
    )
    state = State.PASSED if score == 10 else State.FAILED
    detail = "" if score == 10 else "Traceback (most recent call last):\nWrong: text"
    return Verdict(exercise, exercise, state, score, 10.0, diagnosis=diagnosis, seed=seed, detail=detail)
