"""What says nothing is executed once more, on a worker with nothing beside it: with a client process that we play."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec
import pytest
from fake_link import FakeLink, honest, joined, ready, students, tasks_of_six, troubled
from tiny_class import FakeEngine, TinyClass

from autograder.grading.cluster import cluster_dispatcher
from autograder.grading.grading_errors import GradingError
from autograder.grading.running import task_dispatcher
from autograder.grading.running.task_dispatcher import ATTEMPTS
from autograder.grading.running.worker_messages import Answered, Asked, Give, Left, News, Offer

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.grading.grading_task import Task
    from autograder.grading.running.task_dispatcher import Done


ONE = Offer("here", slots=1, obstacle="")
FOUR = Offer("here", slots=4, obstacle="")


class CrowdedLink(FakeLink):
    """A client process whose workers crowd out some notebooks, as long as others are beside them."""

    def __init__(self, *news: News, crowded: Iterable[str] = ()) -> None:
        super().__init__(*news)
        self.crowded = set(crowded)
        self.seen: list[tuple[str, bool, int]] = []
        """Of each order: its notebook, whether it has its share only, and how many its worker holds then."""
        self.answer = self.crowd

    def crowd(self, give: Give, task: Task) -> News | None:
        together = sum(one.worker == give.worker and one.number in self.in_flight for one in self.given)
        self.seen.append((task.seed, task.limits.beside, together))
        if task.seed in self.crowded and task.limits.beside:
            return said_nothing(give, task, cpu_seconds=float(len(self.seen)))
        return honest(give, task)


def said_nothing(give: Give, task: Task, cpu_seconds: float = 0.0) -> News:
    execution = replace(FakeEngine().execute(task), crowded_out=True, cpu_seconds=cpu_seconds)
    return Answered(give.number, msgspec.json.encode(execution))


@pytest.fixture(autouse=True)
def _version(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_dispatcher, "course_version", lambda: "here")
    monkeypatch.setattr(task_dispatcher, "_RETURN_SECONDS", 0.05)


@pytest.fixture
def tasks(tiny: TinyClass) -> list[Task]:
    """Six notebooks, which their seeds tell apart: a worker learns no name."""
    return [replace(task, seed=task.student) for task in tasks_of_six(tiny)]


def executed(link: FakeLink, tasks: list[Task]) -> list[Done]:
    started: list[str] = []
    done = list(ready(link).execute_all(tasks, lambda task: started.append(task.student)))
    assert started == [task.student for task in tasks]
    assert sorted(one.task.student for one in done) == started
    return done


def test_who_was_crowded_out_comes_once_more_alone_and_that_counts(tasks: list[Task]) -> None:
    link = CrowdedLink(joined("a", FOUR), Asked(), crowded=["student-0", "student-1", "student-4"])
    done = executed(link, tasks)
    assert all(beside for _, beside, _ in link.seen[:6])
    assert link.seen[6:] == [(f"student-{number}", False, 1) for number in (0, 1, 4)]
    assert all(one.execution == FakeEngine().execute(one.task) for one in done)
    assert not any(one.task.limits.beside for one in done), "the task is the one that was given"


def test_of_those_who_come_again_who_was_busiest_comes_last(tasks: list[Task]) -> None:
    used = {"student-0": 90.0, "student-2": 2.0, "student-3": 30.0}
    link = CrowdedLink(joined("a"), Asked())
    link.answer = lambda give, task: (
        said_nothing(give, task, used[task.seed])
        if link.crowd(give, task) and task.limits.beside and task.seed in used
        else honest(give, task)
    )
    executed(link, tasks)
    assert [seed for seed, beside, _ in link.seen if not beside] == ["student-2", "student-3", "student-0"]


def test_who_is_crowded_out_alone_too_is_not_tried_for_ever(tasks: list[Task]) -> None:
    link = FakeLink(joined("a"), joined("b"), Asked())
    link.answer = said_nothing
    done = executed(link, tasks)
    assert len(link.given) == 2 * len(tasks)
    assert all(one.execution.crowded_out for one in done)


def test_a_worker_with_one_place_gives_all_limits_at_once(tasks: list[Task]) -> None:
    link = CrowdedLink(joined("a", ONE), Asked(), crowded=["student-0"])
    executed(link, tasks)
    assert link.seen == [(task.seed, False, 1) for task in tasks]


def test_trouble_comes_once_more_alone_also_where_there_is_one_worker(tasks: list[Task]) -> None:
    link = CrowdedLink(joined("a"), Asked())
    link.answer = lambda give, task: (
        troubled(give, task)
        if link.crowd(give, task) and len(link.seen) <= len(tasks)
        else honest(give, task)
    )
    assert students(executed(link, tasks)) == [task.student for task in tasks]
    assert all((beside, together) == (False, 1) for _, beside, together in link.seen[6:])


def test_notebooks_with_trouble_of_their_own_turn_no_good_worker_out_at_the_end(tasks: list[Task]) -> None:
    told: list[str] = []
    link = FakeLink(*(joined(name, ONE) for name in "abc"), Asked())
    bad = {"student-0", "student-1", "student-2"}
    link.answer = lambda give, task: (troubled if task.seed[:9] in bad else honest)(give, task)
    more = [replace(task, seed=task.seed + "again", student=task.student + "again") for task in tasks]
    dispatcher = ready(link, told)
    for _ in "bc":
        dispatcher._take_in(link.hear(None))
    done = list(dispatcher.execute_all(tasks + more))
    assert sum(bool(one.execution.trouble) for one in done) == 2 * len(bad)
    assert told == []


def test_a_worker_that_comes_meanwhile_takes_one_alone_too(tasks: list[Task]) -> None:
    link = CrowdedLink(joined("a"), Asked(), crowded=[task.seed for task in tasks])
    crowd = link.crowd

    def answer(give: Give, task: Task) -> News | None:
        if len(link.seen) == len(tasks):
            link.news.append(joined("late"))
        return crowd(give, task)

    link.answer = answer
    executed(link, tasks)
    assert all((beside, together) == (False, 1) for _, beside, together in link.seen[6:])
    assert len(link.seen) == 2 * len(tasks)
    assert {give.worker for give in link.given[6:]} == {"a", "late"}


def test_a_worker_that_leaves_with_one_alone_leaves_it_to_another_one_alone(tasks: list[Task]) -> None:
    link = CrowdedLink(joined("a"), joined("b"), Asked(), crowded=["student-0", "student-1"])
    crowd = link.crowd

    def answer(give: Give, task: Task) -> News | None:
        said = crowd(give, task)
        return Left("b") if give.worker == "b" and not task.limits.beside else said

    link.answer = answer
    done = executed(link, tasks)
    assert students(done) == [task.student for task in tasks]
    assert len(link.given) == len(tasks) + 3
    assert all((beside, together) == (False, 1) for _, beside, together in link.seen[6:])


def test_what_another_worker_loses_meanwhile_waits_for_the_one_that_is_alone(tasks: list[Task]) -> None:
    link = CrowdedLink(joined("a"), Asked(), joined("b", ONE), crowded=["student-0"])

    def answer(give: Give, task: Task) -> News | None:
        said = link.crowd(give, task)
        if give.worker == "b":
            return None
        if not task.limits.beside:
            link.news.append(Left("b"))
        return said

    link.answer = answer
    dispatcher = ready(link)
    for _ in range(2):
        dispatcher._take_in(link.hear(None))
    assert students(list(dispatcher.execute_all(tasks[:3]))) == [task.student for task in tasks[:3]]
    assert link.seen[2:] == [("student-2", False, 1), ("student-0", False, 1), ("student-2", True, 1)]


def test_being_crowded_out_counts_as_no_loss(tasks: list[Task]) -> None:
    names = [f"worker-{number}" for number in range(ATTEMPTS)]
    link = CrowdedLink(*map(joined, names), Asked(), crowded=["student-0"])
    link.answer = lambda give, task: (
        link.crowd(give, task) if task.limits.beside or len(link.given) == ATTEMPTS + 1 else Left(give.worker)
    )
    assert students(executed(link, tasks[:1])) == ["student-0"]


def test_who_waits_to_be_alone_when_the_last_worker_is_gone_is_not_done(tasks: list[Task]) -> None:
    link = CrowdedLink(joined("a"), Asked(), crowded=["student-0"])
    link.answer = lambda give, task: link.crowd(give, task) if task.limits.beside else Left("a")
    done: list[Done] = []
    with pytest.raises(GradingError, match="What was graded so far is kept"):
        done.extend(ready(link).execute_all(tasks))
    assert students(done) == [task.student for task in tasks[1:]]
