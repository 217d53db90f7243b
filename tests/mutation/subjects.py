"""What is mutated: two right answers of the bank for each exercise.

The drawings of an exercise are chosen with the mutants of its solution, so these say nothing about the judge.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.authoring.answer_bank import Answer, answers

if TYPE_CHECKING:
    from collections.abc import Iterator

TABLE = Path(__file__).with_name("subjects.toml")


@dataclass(frozen=True)
class Subject:
    """A right answer.

    Attributes:
        exercise: The exercise's id.
        answer: The name of its file in the bank.
        text: The program.
        listed: The bank's entry; None for one that a test makes up.
    """

    exercise: str
    answer: str
    text: str
    listed: Answer | None = None

    @property
    def name(self) -> str:
        """Such as ``"lab_1_2.talker/while_loop_sleep.py"``."""
        return f"{self.exercise}/{self.answer}"

    def verdict(self, text: str, file: Path, seed: str) -> bytes:
        """Judge a changed text in this process, a fork made for it.

        Args:
            text: What is judged.
            file: Where it is to be written.
            seed: What random inputs are drawn from.
        """
        assert self.listed is not None
        file.write_text(text, encoding="utf-8")
        return replace(self.listed, file=file, edit=None).verdict(seed)


def subjects() -> Iterator[Subject]:
    """Everything that is mutated, in the order of the course."""
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    bank = {answer.name: answer for answer in answers()}
    # The judge of a repair is another exercise's, whose answers are changed there.
    for exercise_id in (one.id for one in exercises.unbroken() if not one.hides_causes):
        for name in table[exercise_id]:
            listed = bank[f"{exercise_id}/right/{name}"]
            yield Subject(exercise_id, name, listed.text, listed=listed)
