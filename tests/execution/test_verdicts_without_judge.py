"""What a student is told of a check cell that no judge decided."""

from __future__ import annotations

import pytest

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import CellCheck, CellRun
from autograder.execution.verdicts_without_judge import without_verdict
from autograder.verdict import ASKS_FOR_INPUT

CHECK = CellCheck("lab.one", "One", points=10, worth=10, limit=2)
NO_INPUT = CellRun(
    Ended.RAISED,
    error="StdinNotImplementedError: raw_input was called, but this frontend does not support input requests.",
)
UNDEFINED = CellRun(Ended.RAISED, error="NameError: name 'TalkerNode' is not defined")


@pytest.mark.parametrize(
    ("run", "before", "begins"),
    [
        (UNDEFINED, [("n = int(input())", NO_INPUT)], "The cell that begins with “n = int(input())” stopped"),
        (NO_INPUT, [], "This check cell stopped"),
    ],
)
def test_a_question_that_nobody_can_answer_is_named_and_not_quoted(
    run: CellRun, before: list[tuple[str, CellRun]], begins: str
) -> None:
    diagnosis = without_verdict(CHECK, run, before, 10).diagnosis
    assert diagnosis is not None
    assert diagnosis.key == ASKS_FOR_INPUT.key
    assert diagnosis.text.startswith(begins)
    assert diagnosis.text.endswith(ASKS_FOR_INPUT.text)
    assert diagnosis.next_step == ASKS_FOR_INPUT.next_step
