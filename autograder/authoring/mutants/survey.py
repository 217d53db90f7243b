"""Surveys an exercise: which likely mistakes of its solution its drawings tell, and which they do not."""

from __future__ import annotations

import fnmatch
import time
from collections import defaultdict
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import msgspec

from autograder.authoring.answer_bank import answers_folder, in_children
from autograder.authoring.answer_tables import answer_settings
from autograder.authoring.mutants.code import Code
from autograder.authoring.mutants.engine import Mutant, in_all_places, mutants, python_changes
from autograder.authoring.mutants.equivalents import equivalent
from autograder.authoring.mutants.operators.waiting import late
from autograder.authoring.mutants.solutions import Solution, solution
from autograder.authoring.mutants.trials import FRESH, NotOnPaper, Run, paper_task, run_all
from autograder.authoring.reference_files import CannotRecord, judged
from autograder.judge import evidence_files
from autograder.masters.reference_solutions import ReferenceSolution

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.kit.model import Exercise

LATE = late.__name__
"""The operator for callbacks that take long or die after some calls, of which a task says nothing."""
CHECKS = 3
"""How often the judge checks a mutant that passes, each time with other inputs."""
JUDGING_LIMIT = 300.0
"""Time limit in seconds of wall time for these checks."""


@dataclass(frozen=True)
class Tried:
    """A mutant, and what the drawings say of it.

    Attributes:
        mutant: The mutant.
        runs: Its runs; empty if it crashed the process, or never ended.
        why: Why it may pass: a rule of ``equivalents.py``, or the author's row in ``[accepts]``; empty if it may not.
    """

    mutant: Mutant
    runs: Sequence[Run]
    why: str

    @property
    def passed(self) -> int:
        """The number of drawings that let it pass."""
        return sum(run.passed for run in self.runs)

    @property
    def passes(self) -> bool:
        """True if every drawing lets it pass."""
        return bool(self.runs) and self.passed == len(self.runs)

    @property
    def points(self) -> float:
        """The points that it earns on average."""
        return sum(run.points for run in self.runs) / max(1, len(self.runs))

    def outputs(self, drawings: int) -> tuple[str, ...]:
        """Return what it does in the first drawings; empty if it crashes in one of them."""
        found = tuple(run.outputs for run in self.runs[:drawings])
        return found if all(found) else ()


@dataclass(frozen=True)
class Survey:
    """The mutants of a solution.

    Attributes:
        solution: The solution.
        tried: Its mutants, each with its runs.
        seconds: Wall time of the survey.
        stale: The author's rows that accept a mutant that is not made, or that does not pass.
        practice: The number of recorded drawings.
    """

    solution: Solution
    tried: Sequence[Tried]
    seconds: float
    stale: Sequence[str] = ()
    practice: int = 0

    @property
    def aside(self) -> list[Tried]:
        """The mutants that pass, and that may."""
        return [one for one in self.tried if one.passes and one.why]

    @property
    def passing(self) -> list[Tried]:
        """The mutants that every drawing lets pass, and that nothing says may pass."""
        return [one for one in self.tried if one.passes and not one.why]

    @property
    def by_chance(self) -> list[Tried]:
        """The mutants that some drawings let pass, and others do not."""
        return [one for one in self.tried if one.passed and not one.passes and not one.why]

    @property
    def rejected(self) -> list[Tried]:
        """The mutants that no drawing lets pass."""
        return [one for one in self.tried if not one.passed]

    @property
    def alike(self) -> list[list[Tried]]:
        """The groups of rejected mutants of several meanings that no recorded drawing parts."""
        groups: dict[tuple[str, ...], list[Tried]] = defaultdict(list)
        for one in self.rejected:
            if did := one.outputs(self.practice):
                groups[did].append(one)
        return [group for group in groups.values() if len({_changed(one.mutant) for one in group}) > 1]

    @property
    def is_ready(self) -> bool:
        """True if no mutant passes that may not, and each row of the author is needed."""
        return not (self.passing or self.stale)


def _changed(mutant: Mutant) -> tuple[str, int]:
    """Return what a mutant changes, by which it is another meaning: two wrong numbers in one place are not."""
    is_number = mutant.operator in ("number", "unit", "number_of_another_place")
    return "number" if is_number else f"{mutant.operator} {mutant.kind}", mutant.start


def own_mutants(of: Solution) -> list[Mutant]:
    """Return the mutants of a solution in the student's lines."""
    changes = [
        (operator, edit)
        for operator, edit in python_changes(Code(of.text, subject=of.root))
        if operator != LATE and any(of.is_own(piece.start) for piece in edit.pieces)
    ]
    return mutants(of.text, [*changes, *in_all_places(changes)])


def survey(exercise: Exercise, *, fresh: int = FRESH, must_be_recorded: bool = True) -> Survey:
    """Make the mutants of an exercise's solution, and run them on paper.

    Args:
        exercise: The exercise.
        fresh: The number of fresh drawings, beside those that are recorded.
        must_be_recorded: False to take what the solution does on paper for its recording, for an author who changes the
            drawings.

    Raises:
        NotOnPaper: The exercise cannot be run on paper.
    """
    began, found = time.monotonic(), _solution(exercise)
    stored = evidence_files.load_reference(exercise.id)
    task = paper_task(
        exercise, stored, found.text, found.root, fresh=fresh, must_be_recorded=must_be_recorded
    )
    from autograder.authoring.mutants.blind_answers import OPERATOR, blind_answers  # imports rclpy

    made = [*own_mutants(found), *blind_answers(task)]
    runs = {one.key: of for one, of in run_all(task, ((mutant, mutant.text) for mutant in made))}
    for one in made:
        if one.operator == OPERATOR:  # the practice drawings, of which it is made, do not count
            runs[one.key] = runs[one.key][len(task.practice) :]
    return _survey(found, made, runs, began, len(task.practice))


def survey_by_judge(exercise: Exercise, *, jobs: int) -> Survey:
    """Make the mutants of an exercise's solution, and have the judge check them, which takes seconds for each.

    Args:
        exercise: The exercise.
        jobs: The number of mutants to judge at the same time.

    Raises:
        NotOnPaper: The solution is files, of which no mutants are made.
    """
    began, found = time.monotonic(), _solution(exercise)
    made = own_mutants(found)
    works = ((one, partial(_checks, exercise.id, one.text, found.root)) for one in made)
    runs = {
        one.key: msgspec.json.decode(outcome.data, type=list[Run]) if outcome.data else []
        for one, outcome in in_children(works, jobs=jobs, limit=JUDGING_LIMIT)
    }
    return _survey(found, made, runs, began, 0)


def _checks(exercise_id: str, text: str, root: str) -> bytes:
    runs: list[Run] = []
    while len(runs) < CHECKS and all(run.passed for run in runs):
        try:
            check = ReferenceSolution(text, root).check_cell(exercise_id)
            report, _ = judged(exercise_id, f"{text}\n\n{check}")
        except CannotRecord:
            return b""
        verdict = report.verdict
        score = verdict.score if verdict is not None else 0.0
        runs.append(Run(f"check {len(runs)}", score, verdict is not None and verdict.passed))
    return msgspec.json.encode(runs)


def _solution(exercise: Exercise) -> Solution:
    found = solution(exercise.id)
    if found is None or exercise.hides_causes:
        raise NotOnPaper(
            "its solution is not a class or a function of a notebook, or it repairs another one's"
        )
    return found


def _reason(accepted: Mapping[str, str], key: str) -> str:
    return next((why for form, why in accepted.items() if fnmatch.fnmatch(key, form)), "")


def _survey(
    of: Solution, made: Sequence[Mutant], runs: Mapping[str, Sequence[Run]], began: float, practice: int
) -> Survey:
    code, accepted = (
        Code(of.text, subject=of.root),
        answer_settings(answers_folder(of.exercise)).accepts,
    )
    tried = [
        Tried(one, runs[one.key], equivalent(code, one, of.root) or _reason(accepted, one.key))
        for one in made
    ]
    passing = [one.mutant.key for one in tried if one.passes]
    stale = [form for form in accepted if not fnmatch.filter(passing, form)]
    return Survey(of, tried, time.monotonic() - began, stale, practice)
