"""A judge gets, with the order for a check, the one drawing of the class that its submission is given."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Self
from unittest.mock import Mock

import pytest

from autograder.grading.grading_task import Task
from autograder.grading.running import task_execution
from autograder.messages.judge_messages import Report

if TYPE_CHECKING:
    from pathlib import Path

TASK = Task("ada", "lab", "lab", (), "0", "1", drawings={"lab.drawn": '{"parts": []}', "lab.unknown": ""})


class Noting:
    """A judge that notes what each order says."""

    orders: ClassVar[list[tuple[str, dict[str, object]]]] = []

    def __init__(self, *_: object, **__: object) -> None: ...

    def __enter__(self) -> Self:
        self.orders.clear()
        return self

    def __exit__(self, *_: object) -> None: ...

    def open(self, exercise_id: str, **more: object) -> None:
        self.orders.append((exercise_id, more))

    def close(self) -> Report:
        return Report(reference="the recording")


def judges(task: Task, folder: Path) -> task_execution._Judges:
    paths = task_execution._Paths(folder, boxed=True, runners=frozenset())
    return task_execution._Judges(task, f"{__name__}:Noting", paths, Mock())


def test_an_order_has_the_drawing_of_its_exercise_and_no_other(tmp_path: Path) -> None:
    with judges(TASK, tmp_path) as made:
        made.open("lab.drawn")
        made.open("lab.same_inputs_for_all")
    assert Noting.orders == [("lab.drawn", {"drawing": '{"parts": []}'}), ("lab.same_inputs_for_all", {})]


def test_without_its_drawing_an_exercise_is_not_checked(tmp_path: Path) -> None:
    with judges(TASK, tmp_path) as made, pytest.raises(task_execution.NoDrawing, match=r"lab\.unknown"):
        made.open("lab.unknown")
    assert Noting.orders == []


def test_the_solution_is_recorded_in_the_drawing_that_the_task_names(tmp_path: Path) -> None:
    task = Task("the solution", "lab.drawn", "3", (), "0", "1", records="drawing 0f1e")
    with judges(task, tmp_path) as made:
        made.open("lab.drawn")
        made.close()
    assert Noting.orders == [("lab.drawn", {"record": True, "drawing": "drawing 0f1e"})]
    assert made.evidence == {"lab.drawn": b"the recording"}


def test_the_evidence_of_a_notebook_has_an_end_however_many_checks_are_flooded(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(task_execution, "MOST_EVIDENCE", 100)
    monkeypatch.setattr(Noting, "close", lambda _: Report(evidence=bytes(40)))
    with judges(TASK, tmp_path) as made:
        for number in range(5):
            made.open(f"lab.exercise_{number}")
            made.close()
    assert list(made.evidence) == ["lab.exercise_0", "lab.exercise_1"]
