"""Whole notebooks about files, graded in boxes. That they get the same without is what `autograder execute` shows."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder import course
from autograder.authoring.notebook_execution import NotebookKind, execution_plan
from autograder.boxes.sandbox import why_impossible
from autograder.grading.running import execution_backends
from tests.tiers import asked_for

if TYPE_CHECKING:
    from autograder.execution.executed_cells import Execution

pytestmark = [pytest.mark.ros, pytest.mark.slow]

needs_boxes = pytest.mark.skipif(bool(why_impossible()), reason=f"no boxes here: {why_impossible()}")
HANDED_OUT = "lab_1_1"
NOTEBOOKS = ("lab_1_3", "exercise_1_1")
"""Lab 1.2 is in the sample class, which is graded in boxes, too (grading/new_classes)."""


@pytest.fixture(scope="module")
def executions(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> dict[tuple[NotebookKind, str], Execution]:
    """What came of the notebooks that this session asks for: of masters, and of one as it is handed out."""
    asked = {(NotebookKind.MASTER, notebook) for notebook in asked_for(request, "notebook")}
    asked.add((NotebookKind.CHAPTER, HANDED_OUT))
    planned = [
        one
        for one in execution_plan(course.root(), (*NOTEBOOKS, HANDED_OUT))
        if (one.kind, one.task.notebook) in asked
    ]
    tasks = [replace(one.task, boxed=True) for one in planned]
    done = execution_backends.execute_all(tasks, tmp_path_factory.mktemp("s"), 2)
    return {(NotebookKind(result.task.student), result.task.notebook): result.execution for result in done}


@needs_boxes
@pytest.mark.parametrize("notebook", NOTEBOOKS)
def test_the_master_gets_full_marks(
    executions: dict[tuple[NotebookKind, str], Execution], notebook: str
) -> None:
    execution = executions[NotebookKind.MASTER, notebook]
    assert execution.trouble == ""
    assert [verdict for verdict in execution.verdicts.values() if verdict.score != verdict.max_score] == []


@needs_boxes
def test_the_chapter_as_it_is_handed_out_gets_none(
    executions: dict[tuple[NotebookKind, str], Execution],
) -> None:
    execution = executions[NotebookKind.CHAPTER, HANDED_OUT]
    assert execution.trouble == ""
    assert {verdict.score for verdict in execution.verdicts.values()} == {0}
