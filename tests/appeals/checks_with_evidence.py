"""A program that judges the reference solution of each exercise, and a wrong answer to it, and keeps the evidence.

``python -m tests.appeals.checks_with_evidence FOLDER lab_1_2.talker.right`` leaves there a file of that
name, and the verdict. It is a process of its own, since judges are forks of a process without threads.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from autograder import exercises
from autograder.authoring.answers import Answer, answers
from autograder.authoring.judging import Turn, judge_all, warm_up
from autograder.recording import program
from autograder.verdict import Verdict, to_json
from tests.judge.notebooks import verdict_in_notebook

JOBS = 6


@dataclass(frozen=True)
class Reference:
    """The solution of a master, judged as in a notebook."""

    exercise: str
    to: Path

    @property
    def name(self) -> str:
        return f"{self.exercise}.right"

    def verdict(self, seed: str, *, warm: bool) -> bytes:
        with tempfile.TemporaryDirectory(prefix="reference-") as folder:
            file = Path(folder, "solution.py")
            file.write_text(program(self.exercise), encoding="utf-8")
            return verdict_in_notebook(self.exercise, file, seed, self.to / self.name)


@dataclass(frozen=True)
class Wrong:
    """A wrong answer of the bank, judged as in a terminal."""

    answer: Answer
    to: Path

    @property
    def name(self) -> str:
        return f"{self.answer.exercise}.wrong"

    def verdict(self, seed: str, *, warm: bool) -> bytes:
        from autograder.judge.subjects.command import checked_here
        from autograder.judge.verdicts.keeping import packed

        with tempfile.TemporaryDirectory(prefix="wrong-") as folder:
            command = self.answer.unpack(Path(folder))
            verdict, checked = checked_here(exercises.get(self.answer.exercise), command, seed, None)
        if checked is not None:
            (self.to / self.name).write_bytes(packed(checked))
        return to_json(verdict)


def main(folder: Path, names: list[str]) -> None:
    """Judge what is named."""
    warm_up()
    wrong: dict[str, Answer] = {}
    for answer in answers():
        if (
            answer.diagnoses and "syntax_error" not in answer.diagnoses
        ):  # of which a judge sees next to nothing
            wrong.setdefault(answer.exercise, answer)
    turns = [
        Turn[Reference | Wrong](subject, "a seed")
        for exercise in exercises.all_ids()
        for subject in (Reference(exercise, folder), Wrong(wrong[exercise], folder))
        if subject.name in names
    ]

    def done(turn: Turn[Reference | Wrong], verdict: Verdict) -> None:
        (folder / f"{turn.subject.name}.json").write_bytes(to_json(verdict))

    judge_all(turns, jobs=JOBS, done=done)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
