"""Every answer of the bank gets the right verdict and the right diagnosis: from kept evidence, and judged itself."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.authoring.answer_bank import Answer, answers
from autograder.judge.machine_fitness import TOO_BUSY
from tests.measure import evidence
from tests.tiers import due

if TYPE_CHECKING:
    from autograder.verdict import Verdict

BANK = list(answers())
JUDGED = [due(answer, answer.name, evidence.is_of_another_bench(answer)) for answer in BANK]


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_what_was_seen_of_each_answer_is_judged_right(exercise_id: str) -> None:
    listed = [answer for answer in BANK if answer.exercise == exercise_id]
    assert [trouble for answer in listed if (trouble := evidence.objection(answer))] == []


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize("answer", JUDGED)
def test_answer_is_judged_right(answer: Answer, verdicts: dict[str, Verdict]) -> None:
    assert answer.name in verdicts, "the judge came to no verdict, twice; its error stands above"
    verdict = verdicts[answer.name]
    if verdict.diagnosis and verdict.diagnosis.text == TOO_BUSY:
        pytest.skip(TOO_BUSY)  # also when none of the others was judged beside it
    assert answer.objection(verdict) == "", verdict.detail


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_the_bank_is_large_enough(exercise_id: str) -> None:
    counts = Counter(answer.file.parent.name for answer in BANK if answer.exercise == exercise_id)
    enough = exercises.get(exercise_id).enough
    assert {kind: least for kind, least in enough.items() if counts[kind] < least} == {}
