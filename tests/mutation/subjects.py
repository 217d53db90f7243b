"""What is mutated: the master's own solution of each exercise, and two right answers of the bank."""

from __future__ import annotations

import ast
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.authoring.answer_bank import Answer, answers
from autograder.authoring.reference_files import CannotRecord, program
from tests.judge.notebooks import verdict_in_notebook

if TYPE_CHECKING:
    from collections.abc import Iterator

TABLE = Path(__file__).with_name("subjects.toml")
REFERENCE = "reference"
"""What a mutant of the master's solution has in its id in place of a file."""


@dataclass(frozen=True)
class Subject:
    """A right answer.

    Attributes:
        exercise: The exercise's id.
        answer: The name of its file in the bank, or ``"reference"``.
        text: The program.
        root: The class or function that is judged; empty where it is the whole program.
        listed: The bank's entry; None for the master's solution.
    """

    exercise: str
    answer: str
    text: str
    root: str = ""
    listed: Answer | None = None

    @property
    def name(self) -> str:
        """Such as ``"lab_1_2.talker/reference"``."""
        return f"{self.exercise}/{self.answer}"

    def verdict(self, text: str, file: Path, seed: str) -> bytes:
        """Judge a changed text in this process, a fork made for it.

        Args:
            text: What is judged.
            file: Where it is to be written.
            seed: What random inputs are drawn from.
        """
        file.write_text(text, encoding="utf-8")
        if self.listed is None:
            return verdict_in_notebook(self.exercise, file, seed)
        return replace(self.listed, file=file, edit=None).verdict(seed)


def subjects() -> Iterator[Subject]:
    """Everything that is mutated, in the order of the course."""
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    bank = {answer.name: answer for answer in answers()}
    # The judge of a repair is another exercise's, whose answers are changed there.
    for exercise_id in (one.id for one in exercises.unbroken() if not one.hides_causes):
        reference = _reference(exercise_id)
        if reference is not None:
            yield reference
        for name in table[exercise_id]:
            listed = bank[f"{exercise_id}/right/{name}"]
            yield Subject(exercise_id, name, listed.text, listed=listed)


def _reference(exercise_id: str) -> Subject | None:
    """The master's solution as the recording runs it; None where it is files on the disk, as the bank has them."""
    try:
        text = program(exercise_id)
    except CannotRecord:
        return None
    check = ast.parse(text).body[-1]
    assert isinstance(check, ast.Expr)
    assert isinstance(check.value, ast.Call)
    judged = check.value.args[1]
    if not isinstance(judged, ast.Name):
        return None
    return Subject(exercise_id, REFERENCE, text, root=judged.id)
