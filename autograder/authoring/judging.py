"""Judges many answers in parallel, each in a fork of a process that has already imported the slow modules."""

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
"""Time limit in seconds of wall time for judging one answer."""


class Judgeable(Protocol):
    """Something that can be judged: an answer of the bank, or an automatically changed copy (a mutant)."""

    @property
    def name(self) -> str:
        """The name that messages use."""
        ...

    def verdict(self, seed: str) -> bytes:
        """Judge the answer in the process that calls this method. Return the verdict as JSON."""
        ...


T = TypeVar("T", bound=Judgeable)


@dataclass(frozen=True)
class Turn(Generic[T]):
    """An answer to judge once, with one seed.

    Attributes:
        subject: The answer to judge.
        seed: The seed of the random inputs.
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
    """Judge answers, in the given order, in forks of this process. The process must have no other threads.

    If an answer gets no verdict, it is judged again at the end, when no other answer is judged.

    Args:
        turns: The answers to judge, each with a seed.
        jobs: The number of answers to judge at the same time.
        done: Called with each verdict when it is ready.
        failed: Called with each answer that got no verdict, even alone, and the reason.
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
    """Judge several answers at the same time. Yield each answer with its verdict, or with why it has no verdict."""
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
    # The parent writes verdicts to its standard output, so the child must not write there.
    private_stdout().close()
    return turn.subject.verdict(turn.seed)


def warm_up() -> None:
    """Import the modules that every fork needs, so that no fork has to import them."""
    from autograder.judge import settings

    settings.prepare_judge()
    from autograder.judge.serving import attached

    attached.imports()
