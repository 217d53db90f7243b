"""What workers say is looked at before anything is made of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import msgspec
import pytest
from tiny_class import FakeEngine, TinyClass

from autograder.boxes.admission import NotAdmitted
from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import CellRun, Execution
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.running.worker_messages import (
    LARGEST_ANSWER,
    LARGEST_OFFER,
    Offer,
    admitted_execution,
    admitted_offer,
)
from autograder.grading.tasks.task_making import task_of
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.grading.grading_task import Task


@pytest.fixture
def task(tiny: TinyClass) -> Task:
    tiny.submit("ada", 6)
    directory = ClassDirectory(tiny.path)
    return task_of(directory, directory.submissions()[0][0], "lab_1_2")[0]


@pytest.fixture
def execution(task: Task) -> Execution:
    return FakeEngine().execute(task)


def first(execution: Execution, **change: Any) -> Execution:
    """The execution with another first verdict."""
    index = min(execution.verdicts)
    return replace(
        execution, verdicts={**execution.verdicts, index: replace(execution.verdicts[index], **change)}
    )


def test_an_honest_answer_comes_through_as_it_is(task: Task, execution: Execution) -> None:
    outputs: tuple[dict[str, Any], ...] = (
        {"output_type": "stream", "name": "stdout", "text": "hello\n"},
        {
            "output_type": "execute_result",
            "data": {"text/plain": "7"},
            "metadata": {},
            "execution_count": None,
        },
        {"output_type": "error", "ename": "ValueError", "evalue": "no", "traceback": ["line"]},
    )
    said = replace(
        execution, cells=(CellRun(Ended.RAISED, outputs, "ValueError: no", 0.2), *execution.cells[1:])
    )
    assert admitted_execution(msgspec.json.encode(said), task) == said


def test_trouble_without_cells_comes_through(task: Task, execution: Execution) -> None:
    said = replace(execution, cells=(), trouble="the worker process ended")
    assert admitted_execution(msgspec.json.encode(said), task) == said
    said = replace(said, trouble="it\x1b[2J\nended" + "!" * 100_000)
    assert admitted_execution(msgspec.json.encode(said), task).trouble.startswith("it\\x1b[2J ended!!!")
    assert len(admitted_execution(msgspec.json.encode(said), task).trouble) == 1_000


FORGERIES: dict[str, tuple[str, Callable[[Execution], Execution]]] = {
    "more points than there are": ("11 of 10 points", lambda e: first(e, score=11.0)),
    "fewer points than none": ("-1 of 10 points", lambda e: first(e, score=-1.0)),
    "another scale": ("100 of 100 points", lambda e: first(e, score=100.0, max_score=100.0)),
    "another exercise": ("a verdict on", lambda e: first(e, exercise="lab_1_3.server")),
    "points for nothing": ("could not be checked", lambda e: first(e, state=State.NOT_CHECKED)),
    "a verdict too few": ("verdicts on other checks", lambda e: replace(e, verdicts={})),
    "a verdict too many": (
        "verdicts on other checks",
        lambda e: replace(e, verdicts={**e.verdicts, 99: e.verdicts[max(e.verdicts)]}),
    ),
    "cells too few": ("cells", lambda e: replace(e, cells=e.cells[1:])),
    "cells too many": ("cells", lambda e: replace(e, cells=e.cells * 2)),
    "no cells and no trouble": ("cells", lambda e: replace(e, cells=())),
}


@pytest.mark.parametrize("forgery", FORGERIES)
def test_what_cannot_be_is_refused(task: Task, execution: Execution, forgery: str) -> None:
    words, forge = FORGERIES[forgery]
    assert admitted_execution(msgspec.json.encode(execution), task)
    with pytest.raises(NotAdmitted, match=words):
        admitted_execution(msgspec.json.encode(forge(execution)), task)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x80\x04K\x01.",
        b"[]",
        b"{}",
        b'{"cells": [], "verdicts": {"2": {"score": NaN}}}',
        b"[" * 100_000,
        b"\xff\xfe",
    ],
)
def test_what_is_no_execution_is_refused(task: Task, data: bytes) -> None:
    with pytest.raises(NotAdmitted, match="it has another form"):
        admitted_execution(data, task)


def test_what_is_too_large_is_not_even_read(task: Task, execution: Execution) -> None:
    with pytest.raises(NotAdmitted, match="bytes"):
        admitted_execution(msgspec.json.encode(execution) + b" " * LARGEST_ANSWER, task)


def test_outputs_are_cut_and_stripped_here_too(task: Task, execution: Execution) -> None:
    outputs: tuple[dict[str, Any], ...] = (
        {
            "output_type": "display_data",
            "data": {"text/html": "<script>", "text/plain": "x"},
            "metadata": {"a": 1},
        },
        {"output_type": "stream", "name": "stdout", "text": "y" * 3 * task.limits.cell_output_bytes},
        {"output_type": "<script>", "text": "z"},
    )
    said = replace(execution, cells=(CellRun(Ended.DONE, outputs), *execution.cells[1:]))
    cell = admitted_execution(msgspec.json.encode(said), task).cells[0]
    assert cell.outputs[0] == {"output_type": "display_data", "data": {"text/plain": "x"}, "metadata": {}}
    assert len(cell.outputs) == 3
    assert len(str(cell.outputs)) < 1.1 * task.limits.cell_output_bytes
    assert "bytes of output were dropped" in cell.outputs[2]["text"]


def test_an_offer_is_looked_at_too() -> None:
    honest = Offer("version", slots=2, obstacle="")
    assert admitted_offer(msgspec.json.encode(honest)) == honest
    for slots in (0, -1, 10**9):
        with pytest.raises(NotAdmitted, match="at the same time"):
            admitted_offer(msgspec.json.encode(Offer("version", slots=slots, obstacle="")))
    for data in (
        b"",
        b"\x80\x04K\x01.",
        b'{"version": 1}',
        b'{"x":' + b"[" * 3_900,
        b" " * (LARGEST_OFFER + 1),
    ):
        with pytest.raises(NotAdmitted, match="it has"):
            admitted_offer(data)
