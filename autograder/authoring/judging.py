"""Judges many answers in parallel, in forks of a process that has done their common imports."""

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
"""Seconds of wall time within which an answer must be judged."""


class Judgeable(Protocol):
    """Something that can be judged: an answer, or a mutant of one."""

    @property
    def name(self) -> str:
        """The name for people."""
        ...

    def verdict(self, seed: str) -> bytes:
        """Judge it in this process, a fork made for it. Return the verdict as JSON."""
        ...


T = TypeVar("T", bound=Judgeable)


@dataclass(frozen=True)
class Turn(Generic[T]):
    """One judging of one thing.

    Attributes:
        subject: The thing to judge.
        seed: The seed of random inputs.
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

    A subject without a verdict is judged once more at the end, alone.

    Args:
        turns: What to judge, and with which inputs.
        jobs: The number of subjects at once.
        done: Called with each verdict as it comes.
        failed: Called with each subject without a verdict, and the reason.
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
    """Judge several at once. Yield each with its verdict as it comes, or with the reason why there is none."""
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
