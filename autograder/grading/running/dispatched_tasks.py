"""Defines the records of the dispatcher: the workers, the tasks that wait, and those that are being executed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.grading.grading_task import Task


@dataclass
class Worker:
    """A worker whose offer was accepted."""

    slots: int
    flights: set[int] = field(default_factory=set)


@dataclass(eq=False)
class Job:
    """A task to execute, with the number of attempts and the workers that have tried it."""

    task: Task
    attempts: int = 0
    tried: set[str] = field(default_factory=set)
    alone: bool = False
    """True if the previous result was not reliable, so that no other task may run on the worker at the same time."""
    cpu_seconds: float = 0.0
    """The processor time of the execution whose result was not reliable, in seconds; 0 if there was none."""

    @property
    def is_new(self) -> bool:
        """True if the task was never given to a worker."""
        return not (self.tried or self.alone)

    @property
    def turn(self) -> tuple[int, float]:
        """The place in the queue: tasks to repeat, then new tasks, then tasks to repeat alone, the shortest first."""
        return (2, self.cpu_seconds) if self.alone else (int(self.is_new), 0.0)


@dataclass(frozen=True)
class Flight:
    """A task that a worker executes; ``deadline`` is the time after which its answer is no longer expected."""

    job: Job
    worker: str
    deadline: float
