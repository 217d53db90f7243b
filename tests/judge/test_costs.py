"""What one mistake costs: the criteria that its task names for it, and no others. Decided from kept evidence."""

from __future__ import annotations

import pytest

from autograder.appeals.replaying import replay
from autograder.authoring.answer_bank import Answer, answers
from tests.cases import cases
from tests.measure import evidence

COSTS = cases(__file__, "COSTS")
"""The criteria that a wrong answer loses."""
BANK = {answer.name: answer for answer in answers()}


@pytest.mark.parametrize("name", COSTS)
def test_a_mistake_costs_its_own_criteria(name: str) -> None:
    answer: Answer = BANK[name]
    record = evidence.record_of(answer, evidence.kept(answer.exercise).get(name))
    verdict = replay(record.seen).now
    assert [one.name for one in verdict.criteria if not one.passed] == COSTS[name].split()
