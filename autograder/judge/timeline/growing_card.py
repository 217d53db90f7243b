"""Tells a waiting student, while a check goes on, which criteria are decided for good and which runs are still to come.

A criterion is decided as met if its own code decides so without a look into a run that is still to come: such a run
raises :class:`StillToCome` if anything but its name is read. So no exercise says which runs its criteria need. A
criterion that is not met is shown with the verdict only, because the look in real time may find it met.
"""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.kit.evidence import Evidence, Part
from autograder.verdict import CriterionResult, Diagnosis, State, failed

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.model import Criterion, Exercise
    from autograder.verdict import Verdict


class StillToCome(Exception):
    """A criterion asks for a run that is still to come."""


class RunToCome(Part):
    """A run that is still to come. Only its name is known."""

    def __getattribute__(self, attribute: str) -> object:
        """Return the attribute.

        Raises:
            StillToCome: The attribute is one that only the run itself can fill.
        """
        if attribute in ("inputs", "events"):
            raise StillToCome
        return super().__getattribute__(attribute)


def so_far(ended: Evidence) -> Evidence:
    """Return the evidence of a look that goes on, with the runs in the order of the reference's.

    After the reference's runs there may be others, so the last run is always one that is still to come.

    Args:
        ended: The runs of this look that have ended.
    """
    names = dict.fromkeys(part.name for part in (*ended.reference.parts, *ended))
    runs = {part.name: part for part in ended}
    return replace(ended, parts=[*(runs.get(name) or RunToCome(name) for name in names), RunToCome("")])


class GrowingCard:
    """The card of a check that goes on. What it has shown as decided stays as it is.

    Args:
        decide: Returns the result of a criterion.
        tell: Shows a verdict whose criteria are met or still to come, and :attr:`words`.

    Attributes:
        words: A sentence about the first look, during the second one.
    """

    def __init__(
        self,
        exercise: Exercise,
        decide: Callable[[Exercise, Criterion, Evidence], CriterionResult],
        tell: Callable[[Verdict, str], None],
    ) -> None:
        self._exercise, self._decide, self._tell = exercise, decide, tell
        self.words = ""
        self._met: dict[str, CriterionResult] = {}

    def begin(self, ended: Evidence) -> None:
        """Show what is decided at the beginning of a run.

        Args:
            ended: The runs of this look that have ended.
        """
        evidence = so_far(ended)
        # A wrong name fails a criterion that is met otherwise.
        decides = ended.parts and not any(run.of("misnamed") for run in ended)
        for criterion in self._exercise.criteria if decides else ():
            with contextlib.suppress(StillToCome):
                result = self._decide(self._exercise, criterion, evidence)
                if result.passed:
                    self._met.setdefault(criterion.name, result)
        criteria = tuple(self._met.get(one.name) or self._to_come(one) for one in self._exercise.criteria)
        one = self._exercise
        words = Diagnosis("so_far", _words(evidence), hidden=True)
        score = sum(met.points for met in self._met.values())
        verdict = failed(one.id, one.title, float(one.points), words)
        self._tell(replace(verdict, state=State.CHECKING, score=score, criteria=criteria), self.words)

    def _to_come(self, one: Criterion) -> CriterionResult:
        counts = self._exercise.counts.get(one.name, "")
        return CriterionResult(one.name, one.title, one.points, None, "", "", counts)


def _words(evidence: Evidence) -> str:
    """Return in words which runs have ended, and which are still to come if there are several."""
    *runs, _ = evidence.parts
    left = [run.name for run in runs if isinstance(run, RunToCome)]
    ended = [run.name for run in runs if not isinstance(run, RunToCome)]
    look = "Not all was as asked, so the judge looks again, in real time. " if evidence.real_time else ""
    if not ended:
        return f"{look}The judge watches your code."
    to_come = f" Still to come: {_listed(left)}." if left else ""
    return f"{look}Runs that have ended: {_listed(ended)}.{to_come}"


def _listed(names: Sequence[str]) -> str:
    return "; ".join(f"“{name}”" for name in names)
