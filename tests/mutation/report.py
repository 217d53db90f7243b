"""The result of a run: the share of mutants that were caught, exercise by exercise, and the survivors."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder import exercises
from tests.mutation import equivalents
from tests.mutation.results import Fate, Result

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from tests.mutation.mutants import Mutant


@dataclass(frozen=True)
class Survivor:
    """A mutant that earned full marks.

    Attributes:
        id: The mutant's.
        line: The line of the answer that is changed.
        difference: What is changed.
        seeds: The inputs with which it survived.
        caught: With how many other inputs it was caught.
    """

    id: str
    line: int
    difference: str
    seeds: tuple[str, ...]
    caught: int


@dataclass(frozen=True)
class Tally:
    """How many mutants came to what end.

    Attributes:
        killed: Rejected with every input.
        told: Of these, how many with a specific diagnosis.
        survived: Passed at least once, and are not entered as equivalent.
        equivalent: Passed, and are.
        not_checked: Have no verdict.
    """

    killed: int = 0
    told: int = 0
    survived: int = 0
    equivalent: int = 0
    not_checked: int = 0

    @property
    def share(self) -> float:
        """Killed of those that ought to be; 1 where there are none."""
        judged = self.killed + self.survived
        return self.killed / judged if judged else 1.0

    def __add__(self, other: Tally) -> Tally:
        return Tally(
            self.killed + other.killed,
            self.told + other.told,
            self.survived + other.survived,
            self.equivalent + other.equivalent,
            self.not_checked + other.not_checked,
        )


@dataclass(frozen=True)
class Report:
    """All of a run.

    Attributes:
        made: How many mutants there are of the exercises that were looked at.
        tallies: By exercise, in the order of the course.
        survivors: To be caught, or to be entered as equivalent.
        caught_equivalents: Ids that are entered as equivalent by themselves and were rejected: a right answer that
            fails, or an entry that is wrong.
        diagnoses: How often each diagnosis was given.
    """

    made: int
    tallies: dict[str, Tally]
    survivors: tuple[Survivor, ...]
    caught_equivalents: tuple[str, ...]
    diagnoses: dict[str, int] = field(default_factory=dict)

    @property
    def total(self) -> Tally:
        """Of all exercises."""
        return sum(self.tallies.values(), Tally())


def report(made: int, mutants: Sequence[Mutant], results: Iterable[Result]) -> Report:
    """What the results of some mutants come to.

    Args:
        made: How many mutants there are in all.
        mutants: Those that were judged.
        results: Of these, perhaps several for each.
    """
    by_id: dict[str, list[Result]] = defaultdict(list)
    for result in results:
        by_id[result.id].append(result)
    tallies: dict[str, Tally] = {}
    survivors, caught, diagnoses = [], [], defaultdict[str, int](int)
    for mutant in mutants:
        own = by_id.get(mutant.id)
        if not own:
            continue
        fate = fate_of(mutant.id, own)
        told = fate is Fate.KILLED and all(result.told for result in own)
        tallies[mutant.exercise] = tallies.get(mutant.exercise, Tally()) + Tally(
            **{fate.value: 1}, told=int(told)
        )
        if fate is Fate.SURVIVED:
            survivors.append(_survivor(mutant, own))
        if fate is Fate.KILLED:
            diagnoses[own[0].diagnosis] += 1
            if mutant.id in equivalents.table():
                caught.append(mutant.id)
    order = exercises.all_ids()
    return Report(
        made,
        dict(sorted(tallies.items(), key=lambda item: order.index(item[0]))),
        tuple(survivors),
        tuple(caught),
        dict(sorted(diagnoses.items(), key=lambda item: -item[1])),
    )


def fate_of(identity: str, results: Iterable[Result]) -> Fate:
    """What came of a mutant: it survived where it did so with any input."""
    fates = {result.fate for result in results}
    if Fate.SURVIVED in fates:
        return Fate.EQUIVALENT if equivalents.reason(identity) else Fate.SURVIVED
    return Fate.KILLED if Fate.KILLED in fates else Fate.NOT_CHECKED


def _survivor(mutant: Mutant, results: Iterable[Result]) -> Survivor:
    own = list(results)
    seeds = tuple(result.seed for result in own if result.fate is Fate.SURVIVED)
    caught = sum(result.fate is Fate.KILLED for result in own)
    return Survivor(mutant.id, mutant.line, mutant.difference(), seeds, caught)


def text(found: Report) -> str:
    """The report as plain text."""
    lines = [
        f"{'exercise':<30}{'caught':>8}{'told':>7}{'survived':>10}{'equivalent':>12}{'not checked':>13}{'share':>9}"
    ]
    for name, tally in (*found.tallies.items(), ("all", found.total)):
        lines.append(
            f"{name:<30}{tally.killed:>8}{tally.told:>7}{tally.survived:>10}{tally.equivalent:>12}"
            f"{tally.not_checked:>13}{tally.share:>9.1%}"
        )
    for survivor in found.survivors:
        chance = f" (caught with {survivor.caught} other inputs)" if survivor.caught else ""
        lines += ["", f"survived{chance}: {survivor.id}", survivor.difference]
    if found.caught_equivalents:
        lines += ["", "entered as equivalent, and rejected:", *found.caught_equivalents]
    return "\n".join(lines)
