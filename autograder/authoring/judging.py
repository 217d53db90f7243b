"""Answers judged many at a time, in forks of a process that has imported what each of them needs."""

from __future__ import annotations

import select
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from autograder.standard_output import private_stdout
from autograder.verdict import State, Verdict, from_json

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

LIMIT = 240.0
"""Seconds of wall time in which an answer must have been judged."""


class Judged(Protocol):
    """Something that can be judged: an answer, a mutant of one."""

    @property
    def name(self) -> str:
        """The name by which a person finds it."""
        ...

    def verdict(self, seed: str) -> bytes:
        """Judge it in this very process, a fork made for it; the verdict as JSON."""
        ...


T = TypeVar("T", bound=Judged)


@dataclass(frozen=True)
class Turn(Generic[T]):
    """One judging of one thing.

    Attributes:
        subject: What is judged.
        seed: What random inputs are drawn from.
    """

    subject: T
    seed: str


def judge_all(
    turns: Iterable[Turn[T]],
    *,
    jobs: int,
    done: Callable[[Turn[T], Verdict], None],
    failed: Callable[[Turn[T], str], None],
) -> None:
    """Judge, in this order, in forks of this process, which must have no other threads.

    What comes to no verdict is judged once more at the end, with none of the others beside it.

    Args:
        turns: What to judge, and with which inputs.
        jobs: How many at once.
        done: Called with each verdict as it comes.
        failed: Called with what has no verdict, and why.
    """
    again: list[Turn[T]] = []
    for turn, verdict, _ in _judged(turns, jobs):
        if verdict is not None and verdict.state != State.NOT_CHECKED:
            done(turn, verdict)
        else:
            again.append(turn)
    for turn, verdict, trouble in _judged(again, 1):
        if verdict is not None:
            done(turn, verdict)
        else:
            failed(turn, trouble)


def _judged(turns: Iterable[Turn[T]], jobs: int) -> Iterator[tuple[Turn[T], Verdict | None, str]]:
    """Judge so many at once: each with its verdict as it comes, or with why there is none."""
    from autograder.judge.serving.fork import Child

    waiting = deque(turns)
    running: dict[int, tuple[Turn[T], Child]] = {}
    while waiting or running:
        while waiting and len(running) < jobs:
            turn = waiting.popleft()
            child = Child(lambda turn=turn: _verdict_in_child(turn), LIMIT)  # type: ignore[misc]
            running[child.reading] = (turn, child)
        ready, _, _ = select.select(list(running), [], [])
        for descriptor in ready:
            turn, child = running.pop(descriptor)
            outcome = child.result()
            yield turn, from_json(outcome.data) if outcome.data is not None else None, outcome.trouble


def _verdict_in_child(turn: Turn[T]) -> bytes:
    # The parent's standard output is for verdicts.
    private_stdout().close()
    return turn.subject.verdict(turn.seed)


def warm_up() -> None:
    """Import in this process what every fork needs."""
    from autograder.judge import settings

    settings.prepare_judge()
    from autograder.judge.serving import attached

    attached.imports()
