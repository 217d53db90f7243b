"""Gives tasks to workers, and decides which tasks run again and which run alone.

A worker is a machine with a number of slots, each of which executes one task at a time. Usually, this machine is the
only one; :mod:`autograder.grading.cluster.cluster_dispatcher` has the rules for other machines. A task runs again if
its worker ended. It also runs again, but alone on a worker, if the result is not reliable: the grader itself failed, or
other tasks may have used up the memory or processor time that this task needed. Every answer is checked before it is
used (:func:`autograder.grading.running.worker_messages.admitted_execution`).
"""

from __future__ import annotations

import bisect
import itertools
import operator
import time
from collections import deque
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.admission import NotAdmitted
from autograder.grading.grading_errors import GradingError
from autograder.grading.running.dispatched_tasks import Flight, Job, Worker
from autograder.grading.running.worker_messages import (
    Answered,
    Broken,
    Drop,
    Failed,
    Give,
    Joined,
    Left,
    News,
    Offer,
    Order,
    admitted_execution,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

    from autograder.execution.executed_cells import Execution
    from autograder.grading.grading_task import Task
    from autograder.grading.running.process_link import ProcessLink


ATTEMPTS = 3
"""The maximum number of times that a task is given to a worker. If the worker ended each time, the task may be the
cause.
"""
_RETURN_SECONDS = 60.0
"""Seconds to wait for a worker if none is left, because a worker that ended is often started again."""
_EXTRA_SECONDS = 90.0
"""Seconds that a worker may take beyond the time limits of a task before its answer is no longer expected."""
_MOST_IN_FLIGHT = 2_000


@dataclass(frozen=True)
class Done:
    """A task with its execution; ``execution.trouble`` says why the task could not be executed, if it could not."""

    task: Task
    execution: Execution


class Dispatcher:
    """Gives the tasks of one batch to workers.

    Args:
        link: The connection to the workers.
        judge: The Python class of the judge, as ``module:class``.
    """

    def __init__(self, link: ProcessLink, judge: str) -> None:
        self._link, self._judge = link, judge
        self._workers: dict[str, Worker] = {}
        self._waiting: list[Job] = []
        self._flights: dict[int, Flight] = {}
        self._done: deque[Done] = deque()
        self._last_left = time.monotonic()
        """The time when a worker was last lost; before that, the time when the work began."""
        self._number = 0

    def execute_all(
        self, tasks: Iterable[Task], on_start: Callable[[Task], None] = lambda _: None
    ) -> Generator[Done, None, None]:
        """Execute tasks on the workers, and yield results as they are ready.

        Before each result, every free slot gets a task. So the workers are busy while the caller stores the result.

        Args:
            tasks: The tasks in the order in which they begin. The next task is taken when a worker has a free slot.
            on_start: Called when a task is given to a worker for the first time.

        Raises:
            GradingError: The scheduler can no longer be reached, or all workers have ended or were rejected and no
                new worker came in time.
        """
        jobs = (Job(task) for task in tasks)
        while True:
            self._give_out(jobs, on_start)
            if not (self._done or self._flights or self._waiting):
                return
            within = 0.0 if self._done else self._patience()
            if self._done:
                yield self._done.popleft()
            try:
                self._take_in_all(within)
            except GradingError:
                yield from self._done  # these results came before the workers were lost
                raise

    def _patience(self) -> float | None:
        """Return the number of seconds in which a message has to come; None without limit."""
        deadlines = [flight.deadline for flight in self._flights.values()]
        if not self._workers:  # a worker that is started again needs some seconds
            deadlines.append(self._last_left + _RETURN_SECONDS)
        return min(deadlines) - time.monotonic() if deadlines else None

    def _take_in_all(self, within: float | None) -> None:
        """Take in every message that has come. Wait for the first for ``within`` seconds; None without limit.

        Raises:
            GradingError: The workers are lost.
        """
        news = self._link.hear(within)
        while news is not None:
            self._take_in(news)
            news = self._link.hear(0.0)
        now = time.monotonic()
        if not self._workers and now >= self._last_left + _RETURN_SECONDS:
            raise GradingError(f"{self._why_no_worker()} What was graded so far is kept.")
        for number, flight in list(self._flights.items()):
            if number in self._flights and flight.deadline <= now:
                self._silent(number)

    def _give_out(self, jobs: Iterator[Job], on_start: Callable[[Task], None]) -> None:
        """Give a task to every free slot. No tasks are queued at a worker: they would be lost if the worker ended."""
        for address, worker in self._workers.items():
            while len(worker.flights) < worker.slots and len(self._flights) < _MOST_IN_FLIGHT:
                job = self._next_for(address, worker, jobs)
                if job is None:
                    break
                if job.is_new:
                    on_start(job.task)
                self._send(job, address, worker)
        self._look_ahead(jobs)

    def _next_for(self, address: str, worker: Worker, jobs: Iterator[Job]) -> Job | None:
        """Return the next task for a worker; None if there is no task for it now.

        If a worker ended while it ran a task, the task may be the cause. So a worker runs at most one such task at a
        time, if possible one that this worker has not tried before. A task that must run alone waits until no other
        tasks are left and the worker is idle.
        """
        held = [self._flights[number].job for number in worker.flights]
        self._look_ahead(jobs)
        job = next((job for job in self._waiting if self._may_run(job, address, held)), None)
        if job is not None:
            self._waiting.remove(job)
        return job

    def _may_run(self, job: Job, address: str, held: list[Job]) -> bool:
        """Return True if a worker that runs the tasks ``held`` may run this task at the same time."""
        if any(other.alone or job.alone or (job.tried and other.attempts > 1) for other in held):
            return False
        return address not in job.tried or job.tried >= self._workers.keys()

    def _look_ahead(self, jobs: Iterator[Job]) -> None:
        """Put the next new task into the queue if it contains no new task, to know whether any are left."""
        if not any(job.is_new for job in self._waiting):
            for job in itertools.islice(jobs, 1):
                self._wait(job)

    def _wait(self, job: Job) -> None:
        bisect.insort(self._waiting, job, key=operator.attrgetter("turn"))

    def _send(self, job: Job, address: str, worker: Worker) -> None:
        job.attempts += 1
        job.tried.add(address)
        self._number += 1
        # Wait for twice the limit, because the time limits of cells get longer while the machine is overloaded.
        deadline = time.monotonic() + 2 * job.task.limits.longest + _EXTRA_SECONDS
        self._flights[self._number] = Flight(job, address, deadline)
        worker.flights.add(self._number)
        # The student's name is removed, because a worker does not need it.
        task = replace(job.task.beside_others(worker.slots > 1 and not job.alone), student="")
        order = Order(msgspec.Raw(msgspec.json.encode(task)), self._judge)
        self._link.say(Give(self._number, address, msgspec.json.encode(order)))

    def _take_in(self, news: News | None) -> None:
        match news:
            case Joined(address, _, data):
                self._workers[address] = Worker(msgspec.json.decode(data, type=Offer).slots)
            case Left(address, reason):
                self._forget(address, reason or "the worker ended while it ran this submission")
            case Answered(number, data) if number in self._flights:
                self._answered(number, data)
            case Failed(number, reason) if number in self._flights:
                self._lost(number, f"the worker could not run this submission: {reason}")
            case Broken(reason):
                raise GradingError(
                    f"This machine cannot execute notebooks: {reason}. What was graded so far is kept."
                )
            case _:
                pass  # no message came, or an answer that is no longer needed

    def _forget(self, address: str, reason: str) -> None:
        worker = self._workers.pop(address, None)
        self._last_left = time.monotonic()
        for number in sorted(worker.flights) if worker else ():
            self._lost(number, reason)

    def _answered(self, number: int, data: bytes) -> None:
        flight = self._flights[number]
        try:
            execution = admitted_execution(data, flight.job.task)
        except NotAdmitted as error:
            self._impossible(number, str(error))
            return
        self._land(number)
        self._take_result(flight, execution)

    def _take_result(self, flight: Flight, execution: Execution) -> None:
        """Let the task run again, alone, if its result is not reliable or another worker may succeed; else keep it."""
        job = flight.job
        another_may_do = job.attempts < ATTEMPTS and not job.tried >= self._workers.keys()
        again = bool(execution.trouble) and another_may_do if job.alone else execution.should_retry_alone
        if not again:
            self._done.append(Done(job.task, execution))
            return
        if not execution.trouble:  # the worker did not fail, so this attempt does not count
            job.attempts -= 1
            job.tried.discard(flight.worker)
        job.alone, job.cpu_seconds = True, execution.cpu_seconds
        self._wait(job)

    def _impossible(self, number: int, reason: str) -> None:
        """Take in an answer that no unmodified worker sends."""
        self._lost(number, f"the process that executes notebooks gave an impossible answer: {reason}")

    def _silent(self, number: int) -> None:
        """Take in that no answer has come in time."""
        self._lost(number, "the execution has not ended in time")

    def _why_no_worker(self) -> str:
        return "This machine cannot execute notebooks: the process that executes them did not start in time."

    def _lost(self, number: int, reason: str) -> None:
        job = self._land(number).job
        self._link.say(Drop(number))
        if job.attempts < ATTEMPTS:
            self._wait(job)
        else:
            self._done.append(Done(job.task, job.task.in_trouble(reason)))

    def _land(self, number: int) -> Flight:
        flight = self._flights.pop(number)
        if flight.worker in self._workers:
            self._workers[flight.worker].flights.discard(number)
        return flight
