"""How many tasks are executed at once on this machine, and what is made of the executor's answers.

Which of them are executed once more, alone, is asked of the dispatcher in ``test_tasks_alone.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec
import pytest
from fake_link import FakeLink, honest, joined

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import Cell, CellRun, Execution
from autograder.grading.grading_task import Task
from autograder.grading.running import execution_backends, task_dispatcher
from autograder.grading.running.worker_messages import ADDRESS, Answered, Give, News, Offer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


class Machine(FakeLink):
    """In place of the executor process, which says at its start how many places it has."""

    def __call__(self, module: str, folder: str, slots: str, *_: str, **__: object) -> Machine:
        self.news.append(joined(ADDRESS, Offer("", int(slots), "")))
        return self

    def __enter__(self) -> Machine:
        return self

    def __exit__(self, *_: object) -> None: ...


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Machine:
    made = Machine()
    monkeypatch.setattr(execution_backends, "ProcessLink", made)
    return made


def executed(folder: Path, students: str, workers: int | None = 3, cells: int = 0) -> dict[str, Execution]:
    """What comes of the work of students; a worker is not told a name, but the notebook has it, too."""
    tasks = [Task(student, "lab", student, (Cell(""),) * cells, "0", "1") for student in students]
    return {
        done.task.student: done.execution for done in execution_backends.execute_all(tasks, folder, workers)
    }


@pytest.mark.parametrize(("gib", "number"), [(64, 8), (16, 8), (6, 8), (4, 4), (2, 1)])
def test_there_are_never_more_at_once_than_have_room_if_each_takes_its_share(gib: int, number: int) -> None:
    free = gib * 2**30
    assert execution_backends.at_once(2, free) == number
    assert number == 1 or number * execution_backends.BOX_BYTES < free


def test_so_many_are_at_work_at_once_and_no_more(
    machine: Machine, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(execution_backends, "at_once", lambda *_: 4)
    assert len(executed(tmp_path, "abcdefghijkl", None)) == 12
    assert machine.most_in_flight == 4


def test_each_execution_has_all_of_the_processor_time(machine: Machine, tmp_path: Path) -> None:
    given: list[float] = []

    def crowd(give: Give, task: Task) -> News:
        given.append(task.limits.cpu_seconds)
        run = CellRun(Ended.DONE)
        said = Execution((run,), crowded_out=task.limits.beside, cpu_seconds=120.0)
        return Answered(give.number, msgspec.json.encode(said))

    machine.answer = crowd
    executed(tmp_path, "a", cells=1)
    assert given == [200.0, 200.0], "it uses 120 s of its 200 s, and others crowded it before"


def test_an_answer_that_is_not_possible_is_never_used(machine: Machine, tmp_path: Path) -> None:
    def forge(give: Give, task: Task) -> News:
        forged = Execution((CellRun(Ended.DONE), CellRun(Ended.DONE)))
        if task.notebook == "b":
            return Answered(give.number, msgspec.json.encode(forged))
        return honest(give, task)

    machine.answer = forge
    results = executed(tmp_path, "abc")
    assert "gave an impossible answer: it has 2 cells, and the notebook has 0" in results["b"].trouble
    assert not results["b"].cells
    assert not results["a"].trouble + results["c"].trouble
    assert len(machine.given) == 2 + task_dispatcher.ATTEMPTS


def test_an_error_while_a_task_is_prepared_reaches_the_caller(machine: Machine, tmp_path: Path) -> None:
    def tasks() -> Iterator[Task]:
        raise LookupError("no such student")
        yield

    with pytest.raises(LookupError, match="no such student"):
        list(execution_backends.execute_all(tasks(), tmp_path, 2))
