"""What one mistake costs: the criteria that its task names for it, and no others. Decided from kept evidence."""

from __future__ import annotations

import pytest

from autograder.appeals.replaying import replay
from autograder.authoring.answer_bank import Answer, answers
from tests.measure import evidence

COSTS = {
    # It was built and started: Python came as far as its mistake.
    "lab_1_1.hello/wrong/syntax_error_in_node.workspace": "node line",
    # It waits for the service, whatever it does with the answer.
    "lab_1_3.client/wrong/sum_not_reported_no_f.py": "sum",
    # Both numbers of a request are added wrongly, and the server lives on.
    "lab_1_3.server/wrong/wrong_sum_running.py": "sums together",
    "lab_1_3.server/wrong/wrong_sum_small.py": "sums",
    # The package is built, whatever its fields are.
    "lab_1_3.interface/wrong/interface_fields_type.workspace": "fields wire",
    "lab_1_3.interface/wrong/interface_fields_order.workspace": "fields wire",
    # A server that is right with one goal, and not with two.
    "lab_1_4.server/wrong/older_goal_ended.py": "two",
    "lab_1_4.server/wrong/goals_mixed_up_cancel_stops_all.py": "two",
    # Bad orders are refused by the goal callback, however a good goal ends.
    "lab_1_4.server/wrong/unknown_goal_not_succeeded.py": "sequence two",
    "lab_1_4.server/wrong/wrong_sequence_start.py": "sequence feedback two cancel",
    # The cancel comes at its moment, whichever goal it is.
    "exercise_1_3.cancel/wrong/wrong_order_smaller_goal.py": "goal",
    "exercise_1_3.cancel/wrong/field_typo_keyword.py": "goal refused",
}
"""The criteria that a wrong answer loses."""
BANK = {answer.name: answer for answer in answers()}


@pytest.mark.parametrize("name", COSTS)
def test_a_mistake_costs_its_own_criteria(name: str) -> None:
    answer: Answer = BANK[name]
    record = evidence.record_of(answer, evidence.kept(answer.exercise).get(name))
    verdict = replay(record.seen).now
    assert [one.name for one in verdict.criteria if not one.passed] == COSTS[name].split()
