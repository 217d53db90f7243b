"""Whatever a subject does, each exercise comes to a verdict: no scenario, criterion or mistake raises an exception."""

from __future__ import annotations

import contextlib
import functools
from random import Random
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, strategies

from autograder import exercises
from autograder.cards.text_rendering import card_text
from autograder.judge import evidence_files
from autograder.judge.bench import recorder
from autograder.judge.bench.unreadable import UnreadableSubject
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Evidence
from autograder.verdict import to_json
from tests.drawn import drawn
from tests.judge.hostile_bench import Clock, HostileBench, Odd, seen_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Reference
    from autograder.kit.model import Exercise

EXAMPLES = 4
TEXTS = (
    "", " ", "\x1b[2J", "9" * 5000, "-" * 9000 + "1", "\u0663", "[[[", "[{[]: 1}]", f"[{'9' * 400}, 1]", "{0}", "%s",
    "Traceback (most recent call last):", "  File \"a\", line 1", "@workspace {}", "\ud800", "a\n\nb",
)  # fmt: skip
"""Texts that are read as numbers, literals, tracebacks or reports, and are none."""
ODD = strategies.builds(
    Odd,
    strategies.lists(strategies.text(), max_size=3).map(lambda texts: [*TEXTS, *texts]),
    strategies.lists(strategies.integers(-(2**63), 2**63 - 1), max_size=3).map(lambda more: [0, -1, *more]),
    strategies.lists(strategies.floats(), max_size=3).map(lambda more: [float("nan"), float("inf"), *more]),
)


@functools.cache
def bank_of(exercise_id: str) -> tuple[Reference, Sequence[Event]]:
    reference = evidence_files.load_reference(exercise_id)
    return reference, seen_of(exercise_id, reference)


def look(exercise: Exercise, random: Random, odd: Odd, clock: Clock, before: Evidence | None) -> Evidence:
    reference, events = bank_of(exercise.id)
    bench: Any = HostileBench(events, reference, random, odd, clock, before)
    # As in one_check.look: what ends a look early, and what no judge can read.
    with contextlib.suppress(UnreadableSubject):
        exercise.scenario(bench)
    bench.stop()
    return Evidence(bench.parts, reference, before is not None, before)


@pytest.mark.slow
@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_no_subject_ends_its_judge(exercise_id: str, monkeypatch: pytest.MonkeyPatch) -> None:
    exercise, clock = exercises.get(exercise_id), Clock()
    monkeypatch.setattr(recorder, "time", clock)

    @drawn(EXAMPLES)
    @given(strategies.integers(0, 2**32), ODD)
    def no_subject_ends_it(seed: int, odd: Odd) -> None:
        random, before = Random(seed), None
        for _ in range(2):
            before = evidence = look(exercise, random, odd, clock, before)
            verdict = deciding.decide(exercise, evidence, "a seed")
            card_text(verdict)
            to_json(verdict)
            if verdict.criteria and not verdict.passed:
                deciding.is_certain(exercise, evidence)
                deciding.misnamed(evidence, verdict)

    no_subject_ends_it()
