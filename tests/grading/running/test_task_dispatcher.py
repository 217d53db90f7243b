"""Who gets a task, and what becomes of it when its worker is gone: with a client process that the test plays itself."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import msgspec
import pytest
from fake_link import (
    HERE,
    FakeLink,
    honest,
    joined,
    make_dispatcher,
    ready,
    students,
    task_in,
    tasks_of_six,
    troubled,
)
from tiny_class import FakeEngine, TinyClass

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.cluster import cluster_dispatcher
from autograder.grading.grading_errors import GradingError
from autograder.grading.running import task_dispatcher
from autograder.grading.running.task_dispatcher import ATTEMPTS, Dispatcher
from autograder.grading.running.worker_messages import (
    Answered,
    Asked,
    Broken,
    Failed,
    Give,
    Joined,
    Left,
    News,
    Offer,
    Unfit,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.grading.grading_task import Task
    from autograder.grading.running.task_dispatcher import Done


@pytest.fixture(autouse=True)
def _version(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_dispatcher, "course_version", lambda: "here")
    monkeypatch.setattr(task_dispatcher, "_RETURN_SECONDS", 0.05)


@pytest.fixture
def tasks(tiny: TinyClass) -> list[Task]:
    return tasks_of_six(tiny)


def test_every_task_is_executed_once_and_its_own_result_comes_back(tasks: list[Task]) -> None:
    link = FakeLink(joined("a"), joined("b"), Asked())
    started: list[str] = []
    done = list(ready(link).execute_all(iter(tasks), lambda task: started.append(task.student)))
    assert students(done) == started == [task.student for task in tasks]
    assert len(link.given) == len(tasks)
    assert link.most_in_flight <= 2 * HERE.slots
    assert all(one.execution == FakeEngine().execute(one.task) for one in done)


def test_no_more_tasks_are_made_than_are_in_flight(tasks: list[Task]) -> None:
    made: list[str] = []

    def one_by_one() -> Any:
        for task in tasks:
            made.append(task.student)
            yield task

    link = FakeLink(joined("a"), Asked())
    for _ in ready(link).execute_all(one_by_one()):
        assert len(made) <= len(link.given) + 1
        assert len(link.in_flight) <= HERE.slots
    assert len(made) == len(tasks)


def test_a_worker_learns_no_name_and_no_secret(tasks: list[Task], tiny: TinyClass) -> None:
    link = FakeLink(joined("a"), Asked())
    list(ready(link).execute_all(tasks))
    secret = ClassDirectory(tiny.path).secret
    for give in link.given:
        assert b"student-" not in give.order
        assert secret.hex().encode() not in give.order
        assert str(tiny.path).encode() not in give.order
        limits = replace(tasks[0].limits, beside=True)
        assert task_in(give) == replace(tasks[0], student="", limits=limits)


def test_a_worker_that_leaves_costs_only_its_tasks_again(tasks: list[Task]) -> None:
    link = FakeLink(joined("a"), joined("b"), Asked())

    def answer(give: Give, task: Task) -> News | None:
        if give.worker == "b":
            return Left("b") if sum(one.worker == "b" for one in link.given) == HERE.slots else None
        return honest(give, task)

    link.answer = answer
    told: list[str] = []
    done = list(ready(link, told).execute_all(tasks))
    assert students(done) == [task.student for task in tasks]
    assert told == ["The worker name-b (b) has ended: the notebooks that it was executing run again."]
    assert len(link.given) == len(tasks) + 2
    lost = [give for give in link.given if give.worker == "b"]
    again = [give for give in link.given[link.given.index(lost[-1]) :] if give.worker == "a"]
    assert len(again) == len(lost) == HERE.slots


def test_a_task_that_costs_worker_after_worker_is_given_up(tasks: list[Task]) -> None:
    link = FakeLink(*(joined(name) for name in "abcdefgh"), Asked())
    poison = tasks[0].seed + "!"
    tasks[2] = replace(tasks[2], seed=poison)
    link.answer = lambda give, task: Left(give.worker) if task.seed == poison else honest(give, task)
    dispatcher = ready(link)
    for _ in "abcdefgh":
        dispatcher._take_in(link.hear(None))
    done = list(dispatcher.execute_all(tasks))
    assert len(done) == len(tasks)
    given_up = [one for one in done if one.execution.trouble]
    assert [one.task.student for one in given_up] == [tasks[2].student]
    assert given_up[0].execution.verdicts.keys() == FakeEngine().execute(tasks[0]).verdicts.keys()
    assert sum(task_in(give).seed == poison for give in link.given) == ATTEMPTS


BAD: dict[str, tuple[Callable[[Give, Task], News | None], str]] = {
    "full": (lambda give, _: Failed(give.number, "no room"), ""),
    "sick": (troubled, "the worker failed on 3 notebooks in a row: no space left."),
    "forges": (
        lambda give, _: Answered(give.number, b"\x80\x04K\x01."),
        "the worker sent an impossible answer: it has another form",
    ),
    "silent": (lambda *_: None, "the worker has not answered in time. Start it again."),
}
"""What a worker answers, and why it is turned out; empty where it is not."""


@pytest.mark.parametrize("kind", BAD)
def test_a_bad_worker_does_not_swallow_the_class(
    tasks: list[Task], monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    answer, why = BAD[kind]
    if kind == "silent":
        monkeypatch.setattr(task_dispatcher, "_EXTRA_SECONDS", 0.05 - 2 * tasks[0].limits.longest)
    told: list[str] = []
    link = FakeLink(joined("bad"), joined("good"), Asked())
    link.answer = lambda give, task: (answer if give.worker == "bad" else honest)(give, task)
    assert students(list(ready(link, told).execute_all(tasks))) == [task.student for task in tasks]
    assert [f"name-bad (bad) gets no work: {why}" in line for line in told] == [True] * bool(why)
    if kind != "full":
        assert sum(give.worker == "bad" for give in link.given) <= 2 * HERE.slots


def test_trouble_that_is_the_notebooks_own_is_told_and_turns_nobody_out(tasks: list[Task]) -> None:
    told: list[str] = []
    link = FakeLink(joined("a"), Asked())
    link.answer = troubled
    done = list(ready(link, told).execute_all(tasks))
    assert [one.execution.trouble for one in done] == ["no space left"] * len(tasks)
    assert len(link.given) == 2 * len(tasks)
    assert told == []


def test_what_no_worker_can_run_is_given_up(tasks: list[Task]) -> None:
    link = FakeLink(joined("a"), joined("b"), Asked())
    link.answer = lambda give, task: Failed(give.number, "no room")
    done = list(ready(link).execute_all(tasks))
    assert len(done) == len(tasks)
    assert {one.execution.trouble for one in done} == {"the worker could not run this submission: no room"}


def test_forgers_use_up_no_attempt_of_a_notebook(tasks: list[Task]) -> None:
    names = [f"bad-{number}" for number in range(ATTEMPTS + 3)]
    link = FakeLink(*(joined(name, Offer("here", 1, obstacle="")) for name in names), Asked())

    def answer(give: Give, task: Task) -> News:
        if len({given.worker for given in link.given}) == len(names):
            link.news.append(joined("good"))
        return honest(give, task) if give.worker == "good" else Failed(give.number, "no bytes", forged=True)

    link.answer = answer
    started: list[str] = []
    done = list(ready(link).execute_all(tasks[:1], lambda task: started.append(task.student)))
    assert students(done) == started == [tasks[0].student]
    assert len(link.given) == len(names) + 1


@pytest.mark.parametrize(
    ("offer", "words"),
    [
        (Offer("other", 2, obstacle=""), "the worker's version of the course is other, and here it is here"),
        (Offer("here", 2, obstacle="bubblewrap is missing"), "no sandbox: bubblewrap is missing"),
        (Offer("here", 0, obstacle=""), "it offers to execute 0 notebooks"),
    ],
)
def test_a_worker_that_does_not_fit_is_refused_by_name_and_the_others_go_on(
    tasks: list[Task], offer: Offer, words: str
) -> None:
    told: list[str] = []
    link = FakeLink(joined("misfit", offer), joined("a"), Asked())
    assert students(list(ready(link, told).execute_all(tasks))) == [task.student for task in tasks]
    assert {give.worker for give in link.given} == {"a"}
    assert "name-misfit (misfit) gets no work" in told[0]
    assert words in told[0]


def test_without_boxes_asked_for_a_worker_without_a_sandbox_will_do(tasks: list[Task]) -> None:
    link = FakeLink(joined("a", Offer("here", 1, obstacle="none")), Asked())
    assert len(list(ready(link, boxed=False).execute_all(tasks))) == len(tasks)


def test_a_worker_cannot_write_on_the_terminal(tasks: list[Task]) -> None:
    told: list[str] = []
    offer = Offer("other\x1b[2J", 1, obstacle="")
    link = FakeLink(Joined("a\x1b[31m", "b\nTotal: 100", msgspec.json.encode(offer)), Asked())
    with pytest.raises(GradingError, match=r"No worker of the Dask scheduler .* can be given work"):
        make_dispatcher(link, told).await_workers()
    assert "the worker's version of the course" in told[0]
    assert all(letter.isprintable() for letter in told[0])


@pytest.mark.parametrize(
    ("news", "words"),
    [
        (
            [Unfit("tcp://w:1", "w", "ModuleNotFoundError: No module named 'autograder'"), Asked()],
            r"w \(tcp://w:1\): the worker does not have the autograder .* `\./course worker`",
        ),
        ([Asked()], r"has no workers.*course worker tcp://x:1"),
        ([Broken("refused")], r"tcp://x:1 cannot be reached \(refused\)"),
    ],
)
def test_where_nobody_can_work_it_is_said_what_to_do(news: list[News], words: str) -> None:
    with pytest.raises(GradingError, match=words):
        make_dispatcher(FakeLink(*news)).await_workers()


def test_an_executor_that_does_not_start_in_time_is_not_taken_for_a_scheduler(tasks: list[Task]) -> None:
    with pytest.raises(
        GradingError, match=r"This machine cannot execute notebooks: the process .* did not start"
    ):
        list(Dispatcher(cast("Any", FakeLink()), "a:B").execute_all(tasks))


def test_a_worker_that_comes_later_gets_work_too(tasks: list[Task]) -> None:
    link = FakeLink(joined("a", Offer("here", 1, obstacle="")), Asked(), joined("late"))
    assert students(list(ready(link).execute_all(tasks))) == [task.student for task in tasks]
    assert {give.worker for give in link.given} == {"a", "late"}


def test_when_the_last_worker_is_gone_the_batch_waits_a_little_and_then_stops(
    tasks: list[Task], monkeypatch: pytest.MonkeyPatch
) -> None:
    link = FakeLink(joined("a"), Asked())
    link.answer = lambda give, task: honest(give, task) if give.number < 3 else Left("a")
    done: list[Done] = []
    with pytest.raises(GradingError, match="What was graded so far is kept"):
        done.extend(ready(link).execute_all(tasks))
    link = FakeLink(joined("a"), Asked())
    link.answer = lambda give, task: honest(give, task) if give.number != 3 else Left("a")
    monkeypatch.setattr(task_dispatcher, "_RETURN_SECONDS", 30.0)
    running = ready(link).execute_all(tasks)
    assert next(running)
    link.news.append(joined("a again"))
    assert len(list(running)) == len(tasks) - 1


def test_every_free_slot_has_a_task_before_the_caller_gets_a_result(tasks: list[Task]) -> None:
    link = FakeLink(joined("w"))
    for _ in ready(link).execute_all(tasks):
        assert len(link.in_flight) == HERE.slots or len(link.given) == len(tasks)


def test_a_silent_worker_is_judged_after_all_that_came_while_the_caller_was_busy(
    tasks: list[Task], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(task_dispatcher, "_EXTRA_SECONDS", 0.2 - 2 * tasks[0].limits.longest)
    told: list[str] = []
    link = FakeLink(joined("w"))
    done = []
    for one in ready(link, told).execute_all(tasks):
        done.append(one)
        time.sleep(0.25)  # longer than a worker may be silent
    assert (students(done), told) == ([task.student for task in tasks], [])


def test_what_came_before_the_scheduler_was_lost_is_handed_on(tasks: list[Task]) -> None:
    link = FakeLink(joined("w"))
    link.answer = lambda give, task: (
        link.news.append(honest(give, task)) if give.number < 3 else Broken("refused")
    )
    done: list[Done] = []
    with pytest.raises(GradingError, match="cannot be reached"):
        done.extend(ready(link).execute_all(tasks))
    assert students(done) == [task.student for task in tasks[:2]]
