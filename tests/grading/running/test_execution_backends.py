"""How many tasks are executed at once, and which of them are executed once more, when nobody else is."""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from typing import TYPE_CHECKING, Any

import msgspec
import pytest

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import Cell, CellRun, Execution
from autograder.grading.grading_task import Task
from autograder.grading.running import execution_backends, task_dispatcher
from autograder.grading.running.worker_messages import (
    ADDRESS,
    Answered,
    Command,
    Failed,
    Give,
    Joined,
    News,
    Offer,
    Order,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path


class FakeMachine:
    """In place of the executor process: an answer for each execution, and what was seen of them.

    Args:
        answer: Gives the result of an execution, of which it is told how often the student's work was executed before.
        together: Each execution goes on once so many are at work.
    """

    def __init__(self, answer: Callable[[Task, int], Execution], together: int = 1) -> None:
        self._answer = answer
        self._together = threading.Barrier(together, timeout=60)
        self._lock = threading.Lock()
        self._running = 0
        self._news: queue.SimpleQueue[News] = queue.SimpleQueue()
        self.seen: list[tuple[str, bool, int]] = []
        """Of each execution: the student, whether it had its share of memory only, how many ran with it."""

    def __call__(
        self, module: str, folder: str, slots: str, *_: str, scratch: Path, overlays: Sequence[Path]
    ) -> FakeMachine:
        self._news.put(Joined(ADDRESS, ADDRESS, msgspec.json.encode(Offer("", int(slots), ""))))
        return self

    def __enter__(self) -> FakeMachine:
        return self

    def __exit__(self, *_: object) -> None: ...

    def say(self, command: Command) -> None:
        if isinstance(command, Give):
            threading.Thread(target=self._carry_out, args=(command,), daemon=True).start()

    def hear(self, within: float | None) -> News | None:
        with contextlib.suppress(queue.Empty):
            return self._news.get(within != 0, timeout=within)
        return None

    def _carry_out(self, give: Give) -> None:
        order = msgspec.json.decode(give.order, type=Order)
        try:
            execution = self._execute(msgspec.json.decode(bytes(order.task), type=Task))
            self._news.put(Answered(give.number, msgspec.json.encode(execution)))
        except MemoryError:
            self._news.put(Failed(give.number, "MemoryError"))

    def _execute(self, task: Task) -> Execution:
        with self._lock:
            self._running += 1
            times = sum(student == task.notebook for student, _, _ in self.seen)
            self.seen.append((task.notebook, task.limits.beside, self._running))
        self._together.wait()
        time.sleep(0.05)
        with self._lock:
            self._running -= 1
        return self._answer(task, times)


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    def made(
        answer: Callable[[Task, int], Execution],
        students: str,
        workers: int | None = 3,
        together: int = 1,
        cells: int = 0,
    ) -> Any:
        machine = FakeMachine(answer, together)
        monkeypatch.setattr(execution_backends, "ProcessLink", machine)
        # A worker is not told the name of the student: the notebook has it, too.
        tasks = [Task(student, "lab", student, (Cell(""),) * cells, "0", "1") for student in students]
        done = list(execution_backends.execute_all(tasks, tmp_path / "scratch" / "x", workers))
        return {d.task.student: d.execution for d in done}, machine.seen, done

    return made


def test_trouble_is_tried_again_alone_at_the_end(run: Any) -> None:
    def short(task: Task, times: int) -> Execution:
        return Execution((), trouble="no box" if task.notebook in "bd" and not times else "")

    results, seen, done = run(short, "abcdef")
    assert len(done) == 6
    assert {e.trouble for e in results.values()} == {""}
    assert sorted(student for student, _, _ in seen[6:]) == ["b", "d"]
    assert [together for _, _, together in seen[6:]] == [1, 1]


def test_trouble_that_stays_is_told_after_the_second_time(run: Any) -> None:
    results, seen, _ = run(lambda task, times: Execution((), trouble="no box"), "a")
    assert results["a"].trouble == "no box"
    assert len(seen) == 2


def test_who_crowded_out_gets_all_of_it_alone(run: Any) -> None:
    def large(task: Task, times: int) -> Execution:
        return Execution((), crowded_out=task.notebook == "b" and task.limits.beside)

    results, seen, done = run(large, "abc")
    assert not any(execution.crowded_out for execution in results.values())
    assert all(beside for _, beside, _ in seen[:3])
    assert seen[3:] == [("b", False, 1)]
    assert not any(d.task.limits.beside for d in done), "the task is the one that was given"


def test_each_execution_has_all_of_the_processor_time(run: Any) -> None:
    given: dict[str, list[float]] = {"a": [], "b": []}
    used = {"a": 120.0, "b": 201.0}

    def busy(task: Task, times: int) -> Execution:
        given[task.notebook].append(task.limits.cpu_seconds)
        spent = Ended.OUT_OF_CPU if used[task.notebook] > task.limits.cpu_seconds else Ended.DONE
        return Execution(
            (CellRun(spent),), crowded_out=task.limits.beside, cpu_seconds=min(used[task.notebook], 200.0)
        )

    results, _, _ = run(busy, "ab", cells=1)
    assert results["a"].cells[0].ended is Ended.DONE, (
        "it uses 120 s of its 200 s, and others crowded it before"
    )
    assert given["a"] == [200.0, 200.0]
    assert given["b"] == [200.0, 200.0], "what it earns before it has used up its time, it earns in both"


def test_of_those_that_come_again_who_was_busiest_comes_last(run: Any) -> None:
    used = {"a": 90.0, "b": 2.0, "c": 30.0, "d": 60.0}

    def busy(task: Task, times: int) -> Execution:
        trouble = "no box" if task.notebook == "b" and not times else ""
        return Execution((), trouble=trouble, crowded_out=task.limits.beside, cpu_seconds=used[task.notebook])

    _, seen, _ = run(busy, "abcd")
    assert [student for student, _, _ in seen[4:]] == ["b", "c", "d", "a"]


def test_with_one_worker_everybody_has_all_the_memory_at_once(run: Any) -> None:
    _, seen, _ = run(lambda task, times: Execution(()), "ab", 1)
    assert seen == [("a", False, 1), ("b", False, 1)]


@pytest.mark.parametrize(("gib", "number"), [(64, 8), (16, 8), (6, 8), (4, 4), (2, 1)])
def test_there_are_never_more_at_once_than_have_room_if_each_takes_its_share(gib: int, number: int) -> None:
    free = gib * 2**30
    assert execution_backends.at_once(2, free) == number
    assert number == 1 or number * execution_backends.BOX_BYTES < free


def test_so_many_are_at_work_at_once_and_no_more(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(execution_backends, "cores", lambda: 1)
    _, seen, _ = run(lambda task, times: Execution(()), "abcdefghijkl", None, together=4)
    assert max(together for _, _, together in seen) == 4


def test_an_answer_that_is_not_possible_is_never_used(run: Any) -> None:
    forged = Execution((CellRun(Ended.DONE), CellRun(Ended.DONE)))
    results, seen, _ = run(lambda task, times: forged if task.notebook == "b" else Execution(()), "abc")
    assert "gave an impossible answer: it has 2 cells, and the notebook has 0" in results["b"].trouble
    assert not results["b"].cells
    assert not results["a"].trouble + results["c"].trouble
    assert [student for student, _, _ in seen].count("b") == task_dispatcher.ATTEMPTS


def test_an_error_of_the_grader_is_trouble_of_one_task(run: Any) -> None:
    def broken(task: Task, times: int) -> Execution:
        if task.notebook == "a":
            raise MemoryError
        return Execution(())

    results, _, _ = run(broken, "ab")
    assert "MemoryError" in results["a"].trouble
    assert not results["b"].trouble


def test_an_error_while_a_task_is_prepared_reaches_the_caller(tmp_path: Path) -> None:
    def tasks() -> Iterator[Task]:
        raise LookupError("no such student")
        yield

    with pytest.raises(LookupError, match="no such student"):
        list(execution_backends.execute_all(tasks(), tmp_path, 2))
