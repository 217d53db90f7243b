"""Whether a card that grows with the runs of a check would have to take back what it has shown."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.judge.timeline.growing_card import GrowingCard
from autograder.judge.verdicts import deciding

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence
    from autograder.verdict import Verdict


def objection(verdict: Verdict, evidence: Evidence) -> str:
    """What a card would have shown as met, in whichever order the runs of a look came, and is not met in the end."""
    in_the_end = {one.name: one.passed for one in verdict.criteria}
    looks = [evidence] if evidence.before is None else [evidence.before, evidence]
    for look in looks:
        for ended in range(len(look.parts)):
            for runs in combinations(look.parts, ended):
                for name in met_early(verdict.exercise, replace(look, parts=runs)):
                    if not in_the_end.get(name, True):
                        return f"the card would show {name} as met after {[run.name for run in runs]}"
    return ""


def met_early(exercise_id: str, ended: Evidence) -> list[str]:
    """The criteria that a card shows as met after these runs."""
    shown: list[Verdict] = []
    exercise = exercises.get(exercise_id)
    card = GrowingCard(exercise, deciding.criterion_result, lambda verdict, _: shown.append(verdict))
    card.begin(ended)
    return [one.name for one in shown[0].criteria if one.passed]
