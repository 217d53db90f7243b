"""The bank: right and wrong answers to the exercises, and the verdict that the judge must reach for each.

Many answers are judged in parallel, each in a fork of a process that has already imported the slow modules.
"""

from __future__ import annotations

import select
import time
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from autograder import exercises
from autograder.authoring.answer_tables import (
    WORKSPACE,
    ListedAnswer,
    answer_settings,
    listed_answers,
    unpack_workspace,
)
from autograder.kit.model import UNKNOWN
from autograder.kit.oracle.naming.drawn import EFFECT
from autograder.safe_files import HeldFolder
from autograder.standard_output import private_stdout
from autograder.verdict import State, Verdict, from_json, to_json
from course_runtime.python_child import installed_program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path

    from autograder.judge.check_process import ChildResult
    from autograder.judge.one_check import Look
    from autograder.kit.evidence import Reference
    from autograder.messages.judge_messages import Report


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
        base: The workspace of the answer, which a ``*.workspace`` edits and any other answer uses as it is; None if
            the answers to the exercise need no workspace.
        edit: The answer's entry in a table, if the answer is stored there as an edit.
        says: Words that the diagnosis has to contain.
        advice: What the card of a node that does the same says, and the next step; empty if the answer is not recorded
            next to the solution.
    """

    exercise: str
    file: Path
    command: tuple[str, ...]
    diagnoses: tuple[str, ...]
    base: Path | None = None
    edit: ListedAnswer | None = None
    says: str = ""
    advice: tuple[str, ...] = ()

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
        """Write the program and its workspace into a folder, unless the program is a file and has no workspace.

        Args:
            folder: An empty folder.

        Returns:
            The command that runs the answer.

        Raises:
            BadTable: The edit does not fit the base.
        """
        file, workspace = self.file, folder / "ros2_ws"
        if self.base is not None:
            unpack_workspace(self.text if file.suffix == WORKSPACE else "", self.base, workspace)
        if file.suffix != WORKSPACE and (self.edit is not None or self.base is not None):
            file = folder / file.name
            file.write_text(self.text, encoding="utf-8")
        return [part.format(file=file, workspace=workspace) for part in self.command]

    def checked(self, seed: str) -> tuple[Verdict, Look | None]:
        """Judge the answer in this process. Return the verdict, and the evidence unless the judge itself failed."""
        from autograder.judge.command_check import checked_here

        with HeldFolder("autograder-answer-") as folder:
            return checked_here(exercises.get(self.exercise), self.unpack(folder.path), seed, None)

    def recorded(self, reference: Reference) -> Report:
        """Record the answer in this process, in all parts that the recording of the solution has."""
        from autograder.judge.command_check import recorded_here

        with HeldFolder("autograder-answer-") as folder:
            return recorded_here(exercises.get(self.exercise), self.unpack(folder.path), reference)

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
        folder = answers_folder(exercise_id)
        usual = answer_settings(folder)
        for one in listed_answers(folder):
            first, *rest = one.entry.command or usual.command
            command = (_PROGRAMS.get(first, first), *rest)
            diagnoses = (one.entry.diagnosis, *one.entry.also) if one.entry.diagnosis else ()
            if UNKNOWN in diagnoses:
                # An effect is true whatever the cause is, and the drawing decides whether it can be told.
                diagnoses = (*diagnoses, EFFECT)
            base = folder / usual.base if usual.base else None
            edit = one if one.entry.change else None
            advice = (one.entry.card, one.entry.next_step) if one.entry.card else ()
            yield Answer(exercise_id, one.file, command, diagnoses, base, edit, one.entry.says, advice)


def answers_folder(exercise_id: str) -> Path:
    """Return the folder with the answers to an exercise."""
    return exercises.path(exercise_id).with_suffix(".answers")


_JUDGING_LIMIT = 240.0
"""Time limit in seconds of wall time for judging one answer."""


class _Judgeable(Protocol):
    """Something that can be judged: an answer of the bank, or an automatically changed copy (a mutant)."""

    @property
    def name(self) -> str:
        """The name that messages use."""
        ...

    def verdict(self, seed: str) -> bytes:
        """Judge the answer in the process that calls this method. Return the verdict as JSON."""
        ...


T = TypeVar("T", bound=_Judgeable)
W = TypeVar("W")


@dataclass(frozen=True)
class Turn(Generic[T]):
    """An answer to judge once, with one seed.

    Attributes:
        subject: The answer to judge.
        seed: The seed of the random inputs.
    """

    subject: T
    seed: str


def judge_all(
    turns: Iterable[Turn[T]],
    *,
    jobs: int,
    done: Callable[[Turn[T], Verdict], None],
    failed: Callable[[Turn[T], str], None],
) -> None:
    """Judge answers, in the given order, in forks of this process. The process must have no other threads.

    If an answer gets no verdict, it is judged again at the end, when no other answer is judged.

    Args:
        turns: The answers to judge, each with a seed.
        jobs: The number of answers to judge at the same time.
        done: Called with each verdict when it is ready.
        failed: Called with each answer that got no verdict, even alone, and the reason.
    """
    again: list[Turn[T]] = []
    for turn, verdict, _ in _judged(turns, jobs):
        if verdict is not None and verdict.state != State.NOT_CHECKED:
            done(turn, verdict)
        else:
            again.append(turn)
    for turn, verdict, trouble in _judged(again, 1):
        if verdict is not None:
            done(turn, verdict)
        else:
            failed(turn, trouble)


def _judged(turns: Iterable[Turn[T]], jobs: int) -> Iterator[tuple[Turn[T], Verdict | None, str]]:
    """Judge several answers at the same time. Yield each answer with its verdict, or with why it has no verdict."""
    works = ((turn, partial(_verdict_in_child, turn)) for turn in turns)
    for turn, outcome in in_children(works, jobs=jobs, limit=_JUDGING_LIMIT):
        yield turn, from_json(outcome.data) if outcome.data is not None else None, outcome.trouble


def in_children(
    works: Iterable[tuple[W, Callable[[], bytes]]], *, jobs: int, limit: float
) -> Iterator[tuple[W, ChildResult]]:
    """Do works in forks of this process, several at the same time. Yield what each belongs to, and its result.

    Args:
        works: Whatever each work belongs to, and the function that does it.
        jobs: The number of forks at the same time.
        limit: Seconds of wall time after which a fork is killed.
    """
    from autograder.judge.check_process import Child

    waiting = iter(works)
    running: dict[int, tuple[W, Child]] = {}
    while True:
        for owner, work in islice(waiting, jobs - len(running)):
            child = Child(work, limit)
            running[child.reading] = (owner, child)
        if not running:
            return
        soonest = min(child.deadline for _, child in running.values())
        ready, _, _ = select.select(list(running), [], [], max(0.0, soonest - time.monotonic()))
        late = [at for at, (_, child) in running.items() if child.deadline <= time.monotonic()]
        for descriptor in {*ready, *late}:
            owner, child = running.pop(descriptor)
            yield owner, child.result()


def _verdict_in_child(turn: Turn[T]) -> bytes:
    # The parent writes verdicts to its standard output, so the child must not write there.
    private_stdout().close()
    return turn.subject.verdict(turn.seed)


def warm_up() -> None:
    """Import the modules that every fork needs, so that no fork has to import them."""
    from autograder.judge import ros_setup

    ros_setup.prepare_judge()
    from autograder.judge import controlled_judge

    controlled_judge.import_judge()
