"""Scores and endings of an executed notebook, judged without executing one."""

from __future__ import annotations

from dataclasses import replace

import pytest

from autograder.authoring.notebook_execution import NotebookKind, Planned, problems_of
from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import Cell, CellCheck, CellRun, Execution
from autograder.grading.grading_task import Task
from autograder.grading.rebuilding import nbformat_nodes
from autograder.verdict import Diagnosis, State, Verdict

CHECK = CellCheck("lab_1_2.talker", "The talker", 10.0, 10.0, 60.0)
CELL = Cell("check(…)", check=CHECK)
FULL = Verdict("lab_1_2.talker", "The talker", State.PASSED, 10.0, 10.0)
HALF = Verdict(
    "lab_1_2.talker",
    "The talker",
    State.FAILED,
    5.0,
    10.0,
    diagnosis=Diagnosis("topic_name", "The topic is misspelt.", ""),
)
NONE = replace(HALF, score=0.0)


def found(
    kind: NotebookKind, verdict: Verdict | None, value: str = "", ended: Ended = Ended.DONE
) -> list[str]:
    """What is found in a notebook of one check cell."""
    outputs: tuple[dict[str, object], ...] = ()
    if value:
        outputs = ({"output_type": "execute_result", "data": {"text/plain": value}},)
    run = CellRun(ended, outputs)
    planned = Planned(kind, nbformat_nodes.notebook([], {}), Task("s", "a", "n", (CELL,), "", ""))
    verdicts = {} if verdict is None else {0: verdict}
    return [problem.text for problem in problems_of(planned, Execution((run,), verdicts))]


def test_full_marks_for_a_master_and_none_for_a_chapter_are_right() -> None:
    assert found(NotebookKind.MASTER, FULL, "10.0") == []
    assert found(NotebookKind.CHAPTER, NONE, "0.0") == []


def test_a_master_that_misses_points_says_which_and_why() -> None:
    (text,) = found(NotebookKind.MASTER, HALF, "5.0")
    assert text.startswith("earns 5 of 10 points instead of 10")
    assert "topic_name: The topic is misspelt." in text


def test_a_stub_that_earns_points_is_found() -> None:
    (text,) = found(NotebookKind.CHAPTER, HALF, "5.0")
    assert text.startswith("earns 5 of 10 points instead of 0")


def test_a_check_nobody_asked_for_is_found() -> None:
    assert found(NotebookKind.MASTER, None, "10.0") == ["has no verdict"]


@pytest.mark.parametrize("value", ["", "9.0", "'ten'"])
def test_the_value_of_the_cell_must_be_the_score(value: str) -> None:
    (text,) = found(NotebookKind.MASTER, FULL, value)
    assert text.endswith("instead of its score, 10")


@pytest.mark.parametrize("ended", [Ended.TIMED_OUT, Ended.KERNEL_DIED, Ended.NOT_RUN, Ended.RAISED])
def test_a_cell_that_does_not_end_well_is_found(ended: Ended) -> None:
    assert len(found(NotebookKind.CHAPTER, NONE, "", ended)) == 1


def test_trouble_of_the_grader_is_not_called_a_fault_of_the_notebook() -> None:
    planned = Planned(
        NotebookKind.MASTER, nbformat_nodes.notebook([], {}), Task("s", "a", "n", (CELL,), "", "")
    )
    (problem,) = problems_of(planned, Execution((), trouble="no port"))
    assert (problem.cell, problem.text) == (None, "the grader had trouble: no port")
