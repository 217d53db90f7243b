"""The bank: right and wrong answers to the exercises, and the verdict that the judge must reach for each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.authoring.answer_tables import WORKSPACE, Listed, listed, settings
from autograder.authoring.edits import unpack
from autograder.temporary_folders import HeldFolder
from autograder.verdict import State, to_json
from environment.python_child import installed_program

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from autograder.judge.verdicts.trial import Checked
    from autograder.verdict import Verdict

_PROGRAMS = {name: str(installed_program(name)) for name in ("python3", "ros2")}
"""The paths of the programs that run the answers, in the Python environment of this process."""


@dataclass(frozen=True)
class Answer:
    """An answer in the bank, with the verdict that the judge must reach.

    Attributes:
        exercise: The exercise's id.
        file: The program; if it is stored as an edit, the path that the program would have.
        command: The command that runs the program, with placeholders ``{file}`` and ``{workspace}``.
        diagnoses: The accepted diagnoses, as keys of mistakes; empty for a right answer.
        base: The workspace that the answer edits; None for a program.
        edit: The answer's entry in a table, if the answer is stored there as an edit.
        says: Words that the diagnosis has to contain.
    """

    exercise: str
    file: Path
    command: tuple[str, ...]
    diagnoses: tuple[str, ...]
    base: Path | None = None
    edit: Listed | None = None
    says: str = ""

    @property
    def name(self) -> str:
        """The name of the answer, such as ``lab_1_2.talker/wrong/topic_name.py``."""
        return f"{self.exercise}/{self.short_name}"

    @property
    def short_name(self) -> str:
        """The name of the answer without the exercise, such as ``wrong/topic_name.py``."""
        return f"{self.file.parent.name}/{self.file.name}"

    @property
    def text(self) -> str:
        """The text of the program. For a workspace, its first line and its edit.

        Raises:
            BadTable: The edit does not fit the base.
        """
        return self.edit.text() if self.edit else self.file.read_text(encoding="utf-8")

    def unpack(self, folder: Path) -> list[str]:
        """Write the program or workspace into a folder if the answer is stored as an edit.

        Args:
            folder: An empty folder.

        Returns:
            The command that runs the answer.

        Raises:
            BadTable: The edit does not fit the base.
        """
        file, workspace = self.file, folder / "ros2_ws"
        if self.base is not None:
            unpack(self.text, self.base, workspace)
        elif self.edit is not None:
            file = folder / file.name
            file.write_text(self.text, encoding="utf-8")
        return [part.format(file=file, workspace=workspace) for part in self.command]

    def checked(self, seed: str) -> tuple[Verdict, Checked | None]:
        """Judge the answer in this process. Return the verdict, and the evidence unless the judge itself failed."""
        from autograder.judge.subjects.command import checked_here

        exercise = exercises.get(self.exercise)
        with HeldFolder("autograder-answer-") as folder:
            return checked_here(exercise, self.unpack(folder.path), seed, None)

    def verdict(self, seed: str) -> bytes:
        """Judge the answer in this process. Return the verdict as JSON."""
        return to_json(self.checked(seed)[0])

    def objection(self, verdict: Verdict) -> str:
        """Return in words how a verdict differs from the expected one; empty if it is as expected."""
        if verdict.state == State.NOT_CHECKED:
            why = verdict.diagnosis.text if verdict.diagnosis and not verdict.detail else verdict.detail
            return f"could not be checked: {why}"
        key = verdict.diagnosis.key if verdict.diagnosis else ""
        missed = "; ".join(f"{c.name}: {c.seen}" for c in verdict.criteria if not c.passed)
        if not self.diagnoses:
            return "" if verdict.passed else f"a correct answer got {verdict.score:g} ({key}: {missed})"
        if verdict.state != State.FAILED:
            return f"a wrong answer is {verdict.state}"
        if verdict.score >= verdict.max_score:
            return "a wrong answer got full marks"
        if key not in self.diagnoses:
            return f"diagnosed as {key}, not as {' or '.join(self.diagnoses)} ({missed})"
        words = f"{verdict.diagnosis.text} {verdict.diagnosis.next_step}" if verdict.diagnosis else ""
        return "" if self.says in words else f"the card does not contain “{self.says}”, but: {words}"


def answers(of: Sequence[str] = ()) -> Iterator[Answer]:
    """Yield the bank's answers to exercises, in the order of the tables.

    Args:
        of: Ids of exercises; all exercises if empty.

    Raises:
        UnknownExercise: An exercise does not exist.
        BadTable: A table cannot be used.
    """
    for exercise_id in of or exercises.all_ids():
        folder = folder_of(exercise_id)
        usual = settings(folder)
        for one in listed(folder):
            first, *rest = one.entry.command or usual.command
            command = (_PROGRAMS.get(first, first), *rest)
            diagnoses = (one.entry.diagnosis, *one.entry.also) if one.entry.diagnosis else ()
            base = folder / usual.base if one.file.suffix == WORKSPACE else None
            edit = one if one.entry.change else None
            yield Answer(exercise_id, one.file, command, diagnoses, base, edit, one.entry.says)


def named(name: str) -> Answer:
    """Return the answer with a name such as ``lab_1_2.talker/wrong/topic_name.py``.

    Raises:
        StopIteration: The answer does not exist.
    """
    return next(answer for answer in answers() if answer.name == name)


def folder_of(exercise_id: str) -> Path:
    """Return the folder with the answers to an exercise."""
    return exercises.path(exercise_id).with_suffix(".answers")


def longest_first(wanted: Iterable[Answer]) -> list[Answer]:
    """Sort answers so that slow ones start first. Otherwise a slow answer could run alone at the end."""
    return sorted(wanted, key=lambda answer: -exercises.get(answer.exercise).limit)
