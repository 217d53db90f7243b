"""A judge without ROS for tests of everything around it.

The check of the tiny class tells it a number over the judge's socket, and it gives that score. It lives in the
worker process, so tests name it as ``fake_judge:FakeJudge`` with this folder on PYTHONPATH.
"""

from __future__ import annotations

import contextlib
import json
import os
import threading
import traceback
from pathlib import Path
from typing import Self

from autograder.messages.json_lines import listen
from autograder.messages.judge_messages import Report
from autograder.verdict import Diagnosis, State, Verdict


class FakeJudge:
    def __init__(self, socket_path: Path, *, seed: str, **_: object) -> None:
        self._path = socket_path
        self._seed = seed
        self._exercise = ""
        self._said: str | None = None
        self.keeps_evidence = False

    def __enter__(self) -> Self:
        self._listener = listen(self._path)
        threading.Thread(target=self._hear, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._listener.close()

    def open(self, exercise_id: str) -> None:
        self._exercise = exercise_id
        self._said = None
        if stack := os.environ.get("STACK_OF_THE_FAKE_JUDGE"):
            frames = [(frame.filename, frame.name) for frame in traceback.extract_stack()]
            Path(stack).write_text(json.dumps(frames), encoding="utf-8")

    def close(self) -> Report:
        if self._said is None:
            return Report()
        if self._said == "die":
            raise RuntimeError("the judge is gone")
        if self._said == "kill worker":
            os._exit(9)
        if notes := os.environ.get("NOTES_OF_THE_FAKE_JUDGE"):
            with Path(notes).open("a") as file:
                file.write(f"{self._said}\n")
        crowded = self._said.startswith("crowded ")
        found = verdict(self._exercise, float(self._said.removeprefix("crowded ")), self._seed)
        evidence = f"{self._exercise} said {self._said}".encode() if self.keeps_evidence else b""
        return Report(found, evidence=evidence, crowded=crowded)

    def _hear(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                connection, _ = self._listener.accept()
                with connection, connection.makefile("rb") as words:
                    self._said = words.read().decode() or None


def verdict(exercise: str, score: float, seed: str = "") -> Verdict:
    """Passed at 10 points, failed with a diagnosis below."""
    diagnosis = (
        None if score == 10 else Diagnosis("wrong_text", "It says something else.", "Say the right thing.")
    )
    state = State.PASSED if score == 10 else State.FAILED
    detail = "" if score == 10 else "Traceback (most recent call last):\nWrong: text"
    return Verdict(exercise, exercise, state, score, 10.0, diagnosis=diagnosis, seed=seed, detail=detail)
