"""Surveys an exercise: which likely mistakes of its solution its drawings tell, and which they do not."""

from __future__ import annotations

import time
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.authoring.answer_bank import answers_folder
from autograder.authoring.answer_tables import answer_settings
from autograder.authoring.mutants.code import Code
from autograder.authoring.mutants.engine import Mutant, in_all_places, mutants, python_changes
from autograder.authoring.mutants.equivalents import equivalent
from autograder.authoring.mutants.solutions import Solution, solution
from autograder.authoring.mutants.trials import FRESH, NotOnPaper, PaperTask, Run, paper_task, run_all

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

SHOWN = 60
"""The greatest length of a piece of code in a line for the author."""


@dataclass(frozen=True)
class Tried:
    """A mutant, and what the drawings say of it.

    Attributes:
        mutant: The mutant.
        runs: Its runs; empty if it crashed the process, or never ended.
        why: Why it may pass: by a rule, or by the author's row; empty if nothing says so.
    """

    mutant: Mutant
    runs: Sequence[Run]
    why: str

    @property
    def passes(self) -> bool:
        """True if every drawing lets it pass."""
        return bool(self.runs) and all(run.passed for run in self.runs)

    @property
    def passed(self) -> int:
        """The number of drawings that let it pass."""
        return sum(run.passed for run in self.runs)

    def outputs(self, task: PaperTask) -> tuple[str, ...]:
        """Return the outputs in the practice drawings."""
        return tuple(run.outputs for run in self.runs[: len(task.practice)])


@dataclass(frozen=True)
class Survey:
    """The mutants of a solution.

    Attributes:
        solution: The solution.
        task: The exercise on paper.
        tried: Its mutants, each with its runs.
        seconds: Wall time of the survey.
        stale: The author's rows that accept a mutant that is not made, or that does not pass.
    """

    solution: Solution
    task: PaperTask
    tried: Sequence[Tried]
    seconds: float
    stale: Sequence[str]

    @property
    def passing(self) -> list[Tried]:
        """The mutants that every drawing lets pass, and that nothing says may pass."""
        return [one for one in self.tried if one.passes and not one.why]

    @property
    def by_chance(self) -> list[Tried]:
        """The mutants that some drawings let pass, and others do not."""
        return [one for one in self.tried if one.passed and not one.passes and not one.why]

    @property
    def alike(self) -> list[list[Tried]]:
        """The groups of mutants at several places that no practice drawing parts."""
        groups: dict[tuple[str, ...], list[Tried]] = defaultdict(list)
        for one in self.tried:
            if one.runs and not one.passes and not one.why:
                groups[one.outputs(self.task)].append(one)
        return [
            group
            for group in groups.values()
            if len({(one.mutant.operator, one.mutant.start) for one in group}) > 1
        ]

    @property
    def is_ready(self) -> bool:
        """True if no mutant passes that may not."""
        return not self.passing and not self.stale

    def counts(self) -> dict[str, int]:
        """Return how many mutants were made, set aside, rejected, passed by chance, and passed."""
        aside = [one for one in self.tried if one.passes and one.why]
        rejected = len(self.tried) - len(aside) - len(self.passing) - len(self.by_chance)
        return {
            "made": len(self.tried),
            "set aside": len(aside),
            "rejected": rejected,
            "pass by chance": len(self.by_chance),
            "pass": len(self.passing),
        }


def own_mutants(of: Solution) -> list[Mutant]:
    """Return the mutants of a solution in the student's lines."""
    changes = [
        (operator, edit)
        for operator, edit in python_changes(Code(of.text, subject=of.root))
        if any(of.is_own(piece.start) for piece in edit.pieces)
    ]
    return mutants(of.text, [*changes, *in_all_places(changes)])


def survey(exercise_id: str, *, fresh: int = FRESH, must_be_recorded: bool = True) -> Survey:
    """Make the mutants of an exercise's solution, and run them on paper.

    Args:
        exercise_id: The exercise's id.
        fresh: The number of fresh drawings, beside those that are recorded.
        must_be_recorded: False to take what the solution does on paper for its recording, for an author who changes the
            drawings.

    Raises:
        NotOnPaper: The exercise cannot be run on paper.
    """
    began = time.monotonic()
    found = solution(exercise_id)
    if found is None:
        raise NotOnPaper("the solution is not one class or function of a notebook")
    task = paper_task(exercise_id, found.text, found.root, fresh=fresh, must_be_recorded=must_be_recorded)
    code, accepted = (
        Code(found.text, subject=found.root),
        answer_settings(answers_folder(exercise_id)).accepts,
    )
    made = own_mutants(found)
    runs = {mutant.key: of for mutant, of in run_all(task, ((mutant, mutant.text) for mutant in made))}
    tried = [
        Tried(one, runs[one.key], equivalent(found, code, one) or accepted.get(one.key, "")) for one in made
    ]
    passing = {one.mutant.key for one in tried if one.passes}
    stale = [key for key in accepted if key not in passing]
    return Survey(found, task, tried, time.monotonic() - began, stale)


def tell_survey(found: Survey, tell: Callable[[str], object], *, alike: int = 5) -> None:
    """Print the lists for the author.

    Args:
        found: The survey.
        tell: Called with each line.
        alike: The greatest number of groups that are printed of those that no drawing parts.
    """
    counts = ", ".join(f"{count} {what}" for what, count in found.counts().items())
    tell(f"{found.task.exercise.id}: mutants of the solution on paper: {counts} ({found.seconds:.0f} s)")
    drawings = len(found.task.practice) + len(found.task.fresh)
    lists = (
        (f"pass in all {drawings} drawings, so a student with this mistake has full marks:", found.passing),
        (f"pass in some of {drawings} drawings, so chance decides:", found.by_chance),
    )
    for title, listed in lists:
        for number, one in enumerate(listed):
            if not number:
                tell(f"  {title}")
            chance = "" if one.passes else f" ({one.passed})"
            tell(f"    {in_words(found.solution, one.mutant)}{chance}   {one.mutant.key}")
    for group in found.alike[:alike]:
        tell("  no drawing parts these:")
        for one in group[:3]:
            tell(f"    {in_words(found.solution, one.mutant)}")
        if len(group) > 3:
            tell(f"    and {len(group) - 3} more")
    if len(found.alike) > alike:
        tell(f"  {len(found.alike) - alike} more groups that no drawing parts")
    for key in found.stale:
        tell(f"  settings.toml accepts {key}, which does not pass or is not made: take the row out")


def in_words(of: Solution, mutant: Mutant) -> str:
    """Return in one line what is changed in a solution: the line, what stood there, and what stands there now."""
    source = of.text.splitlines()[mutant.line - 1].strip()
    before, after = (_short(piece) for piece in (mutant.before, mutant.after))
    what = f"{mutant.operator.replace('_', ' ')}{f' ({mutant.kind})' * bool(mutant.kind)}"
    everywhere = f", in {mutant.all_of} places" if mutant.all_of > 1 else ""
    change = (
        f"{before} → {after}" if len(after) < SHOWN and "setdefault" not in after else before or "before it"
    )
    return f"“{_short(source)}”: {what}{everywhere}: {change}"


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= SHOWN else f"{line[:SHOWN]}…"
