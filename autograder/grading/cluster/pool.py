"""The workers that are trusted with tasks, the place of each task, and the tasks of workers that are gone."""

from __future__ import annotations

import bisect
import itertools
import operator
import time
from collections import deque
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.cluster.admission import Forged, admitted, admitted_offer, printable
from autograder.grading.cluster.messages import (
    Answered,
    Asked,
    Broken,
    Drop,
    Failed,
    Give,
    Joined,
    Left,
    News,
    Order,
    Unfit,
)
from autograder.grading.errors import GradingError
from autograder.grading.rebuilding.course_version import course_version
from autograder.grading.running.engine import Done

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

    from autograder.boxes.execution import Execution
    from autograder.grading.cluster.link import Link
    from autograder.grading.task import Task

ATTEMPTS = 3
"""A task is given up after so many workers have died with it: it may be what kills them."""
_RETURN_SECONDS = 60.0
"""The time to wait for a worker when none is left: one that died is often started again."""
_EXTRA_SECONDS = 90.0
"""On top of a task's own limits, before its worker counts as gone."""
_MOST_IN_FLIGHT = 2_000
_MOST_TROUBLES = 3


class NoWorkers(GradingError):
    """There is nobody to execute anything."""


class SchedulerGone(GradingError):
    """The scheduler cannot be reached, or no longer."""


@dataclass
class _Worker:
    """A worker that was accepted."""

    name: str
    slots: int
    troubles: int = 0
    """Notebooks in a row that it had trouble with."""
    flights: set[int] = field(default_factory=set)


@dataclass
class _Job:
    """A task that is to be executed, how often that was tried, and on which workers."""

    task: Task
    attempts: int = 0
    tried: set[str] = field(default_factory=set)
    alone: bool = False
    """It has said nothing: now its worker executes nothing else meanwhile."""
    cpu_seconds: float = 0.0
    """What it used when it said nothing."""


@dataclass(frozen=True)
class _Flight:
    job: _Job
    worker: str
    deadline: float


class Pool:
    """The workers of a cluster, for one batch.

    Args:
        link: To the client process.
        address: The scheduler's, for messages.
        judge: What makes a judge, as ``module:class``.
        boxed: Whether tasks are executed in boxes; a worker that cannot is refused then.
        tell: Called with a sentence for the instructor, such as which worker was refused and why.
        return_seconds: How long to wait for a worker when none is left.
    """

    def __init__(
        self,
        link: Link,
        address: str,
        *,
        judge: str,
        boxed: bool,
        tell: Callable[[str], None],
        return_seconds: float = _RETURN_SECONDS,
    ) -> None:
        self._link, self._address = link, address
        self._judge, self._boxed, self._tell = judge, boxed, tell
        self._return_seconds = return_seconds
        self._workers: dict[str, _Worker] = {}
        self._refused: dict[str, str] = {}
        self._new: deque[_Job] = deque()
        self._again: list[_Job] = []
        self._alone: list[_Job] = []
        self._flights: dict[int, _Flight] = {}
        self._done: list[Done] = []
        self._number = 0

    def await_workers(self) -> None:
        """Wait until one is accepted, or until all that there are have been asked.

        Raises:
            SchedulerGone: It cannot be reached.
            NoWorkers: There are none, or none that can be given anything.
        """
        while not self._workers:
            news = self._link.hear(None)
            if isinstance(news, Asked):
                raise NoWorkers(self._nobody())
            self._take_in(news)

    def execute_all(
        self, tasks: Iterable[Task], on_start: Callable[[Task], None] = lambda _: None
    ) -> Generator[Done, None, None]:
        """Execute tasks on the workers; results come as they are ready.

        Args:
            tasks: In the order in which they are begun; taken one by one, when a worker is free.
            on_start: Called when a task is given to a worker for the first time.

        Raises:
            SchedulerGone: It can no longer be reached.
            NoWorkers: Nobody is left, and nobody came back.
        """
        jobs = (_Job(task) for task in tasks)
        alone_until: float | None = None
        while True:
            self._give_out(jobs, on_start)
            if not (self._flights or self._again or self._new or self._alone):
                return
            if self._workers:
                alone_until = None
            elif alone_until is None:
                alone_until = time.monotonic() + self._return_seconds
            self._take_in(self._link.hear(self._seconds_to_wait(alone_until)))
            now = time.monotonic()
            if alone_until is not None and now >= alone_until and not self._workers:
                raise NoWorkers(f"{self._nobody()} What was graded so far is kept.")
            self._give_up_on_silent(now)
            while self._done:
                yield self._done.pop()

    def _give_out(self, jobs: Iterator[_Job], on_start: Callable[[Task], None]) -> None:
        """Fill every free slot; nothing is queued on a worker, so little is lost with it."""
        for address, worker in self._workers.items():
            while len(worker.flights) < worker.slots and len(self._flights) < _MOST_IN_FLIGHT:
                job = self._next_for(address, worker, jobs)
                if job is None:
                    break
                if not (job.tried or job.alone):
                    on_start(job.task)
                self._send(job, address, worker)
        self._look_ahead(jobs)

    def _next_for(self, address: str, worker: _Worker, jobs: Iterator[_Job]) -> _Job | None:
        """The next task of a worker. Of tasks that were lost before only one at a time, and rather not those it lost.

        One of them may be what ends workers, and the other one must not be lost with it again. What is executed alone
        comes when there is nothing else for this worker: it is empty then without anybody waiting for it.
        """
        held = [self._flights[number].job for number in worker.flights]
        if any(job.alone for job in held):
            return None
        if not any(job.attempts > 1 for job in held) and (job := self._taken_from(self._again, address)):
            return job
        self._look_ahead(jobs)
        if self._new:
            return self._new.popleft()
        return None if held else self._taken_from(self._alone, address)

    def _taken_from(self, waiting: list[_Job], address: str) -> _Job | None:
        """The first one that this worker has not tried, or that all have."""
        for job in waiting:
            if address not in job.tried or job.tried >= self._workers.keys():
                waiting.remove(job)
                return job
        return None

    def _look_ahead(self, jobs: Iterator[_Job]) -> None:
        """Have the next new task at hand, or know that there is none."""
        if not self._new:
            self._new.extend(itertools.islice(jobs, 1))

    def _send(self, job: _Job, address: str, worker: _Worker) -> None:
        job.attempts += 1
        job.tried.add(address)
        self._number += 1
        self._flights[self._number] = _Flight(job, address, time.monotonic() + _most_seconds(job.task))
        worker.flights.add(self._number)
        order = self._order(job.task.beside_others(worker.slots > 1 and not job.alone))
        self._link.say(Give(self._number, address, order))

    def _seconds_to_wait(self, alone_until: float | None) -> float | None:
        deadlines = [flight.deadline for flight in self._flights.values()]
        if alone_until is not None:
            deadlines.append(alone_until)
        return min(deadlines) - time.monotonic() if deadlines else None

    def _order(self, task: Task) -> bytes:
        # A worker needs to know nobody's name.
        nameless = msgspec.json.encode(replace(task, student=""))
        return msgspec.json.encode(Order(msgspec.Raw(nameless), self._judge))

    def _take_in(self, news: News | None) -> None:
        match news:
            case Joined(address, name, data):
                self._consider(address, name, data)
            case Unfit(address, name, reason):
                self._refuse(address, name, _could_not_be_asked(reason))
            case Left(address):
                self._forget(address, "its worker ended while it ran this submission")
            case Answered(number, data) if number in self._flights:
                self._answered(number, data)
            case Failed(number, reason, forged) if number in self._flights:
                if forged:
                    self._forged(number, reason)
                else:
                    self._lost(number, f"its worker could not run it: {reason}")
            case Broken(reason):
                raise SchedulerGone(
                    f"The Dask scheduler at {self._address} cannot be reached ({reason}). "
                    "Look whether it runs, and whether its address and its TLS settings are right. "
                    "What was graded so far is kept."
                )
            case _:
                pass  # nobody waits for this any more

    def _consider(self, address: str, name: str, data: bytes) -> None:
        try:
            offer = admitted_offer(data)
        except Forged as error:
            self._refuse(address, name, f"{error}. Look at that machine")
            return
        if offer.version != course_version():
            self._refuse(
                address,
                name,
                f"it has another version of the course ({offer.version:.16}, here it is {course_version()}). "
                "Bring both to the same commit and start the worker again",
            )
        elif self._boxed and offer.obstacle:
            self._refuse(address, name, f"it has no sandbox: {offer.obstacle[:500]}")
        else:
            self._workers[address] = _Worker(name, offer.slots)

    def _refuse(self, address: str, name: str, reason: str) -> None:
        called = printable(address if name == address else f"{name[:100]} ({address})")
        reason = printable(reason)
        self._refused[address] = f"{called}: {reason}"
        self._tell(f"The worker {called} gets no work: {reason}.")

    def _forget(self, address: str, reason: str) -> None:
        self._refused.pop(address, None)
        worker = self._workers.pop(address, None)
        for number in sorted(worker.flights) if worker else ():
            self._lost(number, reason)

    def _answered(self, number: int, data: bytes) -> None:
        flight = self._flights[number]
        try:
            execution = admitted(data, flight.job.task)
        except Forged as error:
            self._forged(number, str(error))
            return
        worker = self._workers[flight.worker]
        self._land(number)
        # Of one executed alone the trouble may be the notebook's, and its like come one after the other.
        if not flight.job.alone:
            worker.troubles = worker.troubles + 1 if execution.trouble else 0
        if self._comes_again(flight.job, execution):
            self._do_alone(flight, execution)
        else:
            self._done.append(Done(flight.job.task, execution))
        if worker.troubles >= _MOST_TROUBLES and len(self._workers) > 1:
            # A full disk, say: it would be done with every notebook at once, and get the next ones.
            self._turn_out(
                flight.worker, f"it had trouble with {worker.troubles} notebooks: {execution.trouble}"
            )

    def _comes_again(self, job: _Job, execution: Execution) -> bool:
        """What says nothing comes once more. Trouble that stays also goes to others: it may be a worker's."""
        if not job.alone:
            return execution.says_nothing
        return bool(execution.trouble) and self._others_may_do(job)

    def _do_alone(self, flight: _Flight, execution: Execution) -> None:
        job = flight.job
        if not execution.trouble:  # its worker is as good as any, and has not lost it
            job.attempts -= 1
            job.tried.discard(flight.worker)
        job.alone, job.cpu_seconds = True, execution.cpu_seconds
        self._wait(job)

    def _wait(self, job: _Job) -> None:
        """A job waits for its next worker; of those that are executed alone, who was busiest comes last."""
        if job.alone:
            bisect.insort(self._alone, job, key=operator.attrgetter("cpu_seconds"))
        else:
            self._again.append(job)

    def _others_may_do(self, job: _Job) -> bool:
        return job.attempts < ATTEMPTS and not job.tried >= self._workers.keys()

    def _forged(self, number: int, reason: str) -> None:
        address = self._flights[number].worker
        for held in self._workers[address].flights:
            self._flights[held].job.attempts -= 1  # the worker's fault, not the notebook's
        self._turn_out(address, f"what it says cannot be: {reason}. Look at that machine")

    def _turn_out(self, address: str, reason: str) -> None:
        """No more work for a worker that was accepted; what it has is done by others."""
        name = self._workers[address].name
        self._forget(address, f"its worker was turned out: {reason}")
        self._refuse(address, name, reason)

    def _give_up_on_silent(self, now: float) -> None:
        for number, flight in list(self._flights.items()):
            if number in self._flights and flight.deadline <= now:
                self._turn_out(flight.worker, "it has not answered in time. Start it again")

    def _lost(self, number: int, reason: str) -> None:
        job = self._land(number).job
        self._link.say(Drop(number))
        if job.attempts < ATTEMPTS:
            self._wait(job)
        else:
            self._done.append(Done(job.task, job.task.in_trouble(reason)))

    def _land(self, number: int) -> _Flight:
        flight = self._flights.pop(number)
        if flight.worker in self._workers:
            self._workers[flight.worker].flights.discard(number)
        return flight

    def _nobody(self) -> str:
        if not self._refused:
            return (
                f"The Dask scheduler at {self._address} has no workers. "
                f"Start some: autograder worker {self._address}"
            )
        reasons = "\n".join(f"  {reason}" for reason in self._refused.values())
        return f"No worker of the Dask scheduler at {self._address} can be given work:\n{reasons}"


def _most_seconds(task: Task) -> float:
    # A local engine tries a task whose process died once more.
    return 2 * task.limits.longest + _EXTRA_SECONDS


def _could_not_be_asked(reason: str) -> str:
    if "No module named" in reason:
        return (
            f"it does not have the autograder ({reason}). Start it with `autograder worker`, "
            "or with the Python of the course's .venv"
        )
    return f"it could not be asked what it offers ({reason})"
