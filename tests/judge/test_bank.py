"""Every answer of the bank gets the right verdict and the right diagnosis."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import pytest

from autograder import exercises

sys.path.insert(0, str(Path(__file__).parent))
from typing import TYPE_CHECKING

from bank import Answer, answers

if TYPE_CHECKING:
    from autograder.verdict import Verdict

BANK = list(answers())


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize("answer", BANK, ids=lambda answer: answer.name)
def test_answer_is_judged_right(answer: Answer, verdicts: dict[str, Verdict]) -> None:
    verdict = verdicts[answer.name]
    assert answer.objection(verdict) == "", verdict.detail


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_the_bank_is_large_enough(exercise_id: str) -> None:
    counts = Counter(answer.file.parent.name for answer in BANK if answer.exercise == exercise_id)
    assert counts["correct"] >= 5
    assert counts["wrong"] >= 8


def test_every_program_is_in_its_table() -> None:
    listed = {answer.file for answer in BANK}
    there = {
        file for kind in ("correct", "wrong") for file in Path(BANK[0].file.parents[2]).glob(f"*/{kind}/*.*")
    }
    there = {file for file in there if file.parents[1].name in exercises.all_ids()}
    assert listed == there
