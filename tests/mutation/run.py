"""Mutants made, judged and counted."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from autograder.authoring.answer_bank import Turn, judge_all
from tests.mutation.mutants import Mutant, mutants, sampled
from tests.mutation.report import Report, report
from tests.mutation.results import Result, keep, kept, no_result, result
from tests.mutation.subjects import subjects

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from autograder.verdict import Verdict


def chosen(parts: Sequence[str], size: int | None, seed: int) -> tuple[int, list[Mutant]]:
    """How many mutants there are, and those that are to be judged.

    Args:
        parts: Parts of their ids; all where empty.
        size: How many are wanted; None for all.
        seed: Decides which are in a sample.
    """
    found = [mutant for subject in subjects() for mutant in mutants(subject)]
    found = [mutant for mutant in found if not parts or any(part in mutant.id for part in parts)]
    return len(found), found if size is None else sampled(found, size, seed)


def judged(
    wanted: Sequence[Mutant],
    *,
    jobs: int,
    repeat: int,
    file: Path | None = None,
    told: Callable[[Result], None] = lambda result: None,
) -> list[Result]:
    """Judge mutants, in forks of this process, which must be warm and have no threads.

    Args:
        wanted: The mutants.
        jobs: How many at once.
        repeat: With how many different inputs each.
        file: Keeps the results; what is in it already is not judged again.
        told: Called with each result as it comes.
    """
    before = kept(file, wanted) if file else []
    have = {(one.id, one.seed) for one in before}
    turns = [Turn(mutant, f"mutant {number}") for number in range(repeat) for mutant in wanted]
    turns = [turn for turn in turns if (turn.subject.id, turn.seed) not in have]
    # Neighbours in the file are alike, and some all take long.
    Random(0).shuffle(turns)
    results = list(before)

    def take(found: Result) -> None:
        results.append(found)
        if file:
            keep(found, file)
        told(found)

    def done(turn: Turn[Mutant], verdict: Verdict) -> None:
        take(result(turn.subject, turn.seed, verdict))

    def failed(turn: Turn[Mutant], trouble: str) -> None:
        take(no_result(turn.subject, turn.seed))

    judge_all(turns, jobs=jobs, done=done, failed=failed)
    return results


def run(
    parts: Sequence[str],
    *,
    size: int | None,
    seed: int,
    jobs: int,
    repeat: int,
    file: Path | None = None,
    told: Callable[[Result], None] = lambda result: None,
) -> Report:
    """Make mutants, judge them, count them; the arguments are those of :func:`chosen` and :func:`judged`."""
    made, wanted = chosen(parts, size, seed)
    return report(made, wanted, judged(wanted, jobs=jobs, repeat=repeat, file=file, told=told))
