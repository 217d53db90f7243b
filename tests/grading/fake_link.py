"""Play the client process of a cluster in tests: a dispatcher that talks to it, and the answers of workers."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import msgspec
from tiny_class import FakeEngine, TinyClass

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.cluster.cluster_dispatcher import ClusterDispatcher
from autograder.grading.grading_task import Task
from autograder.grading.running.worker_messages import Answered, Command, Give, Joined, News, Offer, Order
from autograder.grading.tasks.task_making import task_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.grading.running.task_dispatcher import Done

HERE = Offer("here", slots=2, obstacle="")


class FakeLink:
    """Plays the client process: hands out news, and answers what it is given as the test says."""

    def __init__(self, *news: News) -> None:
        self.news = deque(news)
        self.given: list[Give] = []
        self.in_flight: set[int] = set()
        self.most_in_flight = 0
        self.answer: Callable[[Give, Task], News | None] = honest

    def say(self, command: Command) -> None:
        if not isinstance(command, Give):
            self.in_flight.discard(command.number)
            return
        self.given.append(command)
        assert len(self.given) < 200, "the same notebooks are given again and again"
        self.in_flight.add(command.number)
        self.most_in_flight = max(self.most_in_flight, len(self.in_flight))
        news = self.answer(command, task_in(command))
        if news is not None:
            self.news.append(news)

    def hear(self, within: float | None) -> News | None:
        if not self.news:
            assert within is not None, "nothing would ever happen"
            time.sleep(max(0.0, within) and 0.01)
            return None
        news = self.news.popleft()
        if isinstance(news, Answered):
            self.in_flight.discard(news.number)
        return news


def task_in(give: Give) -> Task:
    return msgspec.json.decode(msgspec.json.decode(give.order, type=Order).task, type=Task)


def honest(give: Give, task: Task) -> News:
    return Answered(give.number, msgspec.json.encode(FakeEngine().execute(task)))


def joined(address: str, offer: Offer = HERE) -> Joined:
    return Joined(address, f"name-{address}", msgspec.json.encode(offer))


def troubled(give: Give, task: Task) -> News:
    return Answered(
        give.number, msgspec.json.encode(replace(FakeEngine().execute(task), trouble="no space left"))
    )


def tasks_of_six(tiny: TinyClass) -> list[Task]:
    """The same work of six students."""
    tiny.submit("ada", 6)
    directory = ClassDirectory(tiny.path)
    task, _ = task_of(directory, directory.submissions()[0][0], "lab_1_2")
    return [replace(task, student=f"student-{number}") for number in range(6)]


def make_dispatcher(
    link: FakeLink, told: list[str] | None = None, *, boxed: bool = True
) -> ClusterDispatcher:
    tell = (told if told is not None else []).append
    return ClusterDispatcher(cast("Any", link), "a:B", "tcp://x:1", boxed=boxed, tell=tell)


def ready(link: FakeLink, told: list[str] | None = None, **options: Any) -> ClusterDispatcher:
    """A dispatcher that knows its workers."""
    dispatcher = make_dispatcher(link, told, **options)
    dispatcher.await_workers()
    return dispatcher


def students(done: list[Done]) -> list[str]:
    return sorted(one.task.student for one in done if not one.execution.trouble)
