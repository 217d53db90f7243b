"""Limits the time in which the judge computes a verdict from a subject's output and messages.

A limit is needed because some output of a student's program would keep a criterion busy almost forever. The limit is in
processor time, so that it has the same effect on a busy machine as on an idle one.
"""

from __future__ import annotations

import contextlib
import signal
import threading
import time
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.verdict import Diagnosis, failed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from autograder.kit.model import Exercise
    from autograder.verdict import Verdict

LIMIT = 10.0
"""The limit in seconds of processor time for one verdict, which usually takes a hundredth of a second."""
AGAIN = 0.05
"""The seconds of processor time after which the signal is sent again if the verdict is still not ready.

The signal's exception may be lost, because Python prints and drops an exception that is raised in a destructor or in a
callback of the garbage collector.
"""
SURE = 1.0
"""If a verdict has taken this many seconds of processor time, the cause is the subject's output, not a busy machine."""
SIGNAL = signal.SIGVTALRM
"""The signal that stops the computation of a verdict. At other times the judge ignores this signal."""


class Undecided(BaseException):
    """The judge did not reach a verdict in time.

    This is a BaseException, so that ``except Exception`` does not catch it.
    """


@contextlib.contextmanager
def limited(seconds: float = LIMIT) -> Iterator[None]:
    """Run the block within a limit of processor time.

    Args:
        seconds: Limit in seconds of processor time.

    Raises:
        Undecided: The time is over, or the parent process has sent ``SIGNAL`` after the block used at least
            :data:`SURE` seconds of processor time: the subject's output is the cause, and the verdict says so. An
            earlier signal is ignored here: the machine is the cause, and the parent process ends the check without a
            verdict.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread can handle signals, so elsewhere there is no limit
        return

    began = time.process_time()

    def give_up(*_: object) -> None:
        if time.process_time() - began >= min(seconds, SURE):
            raise Undecided

    before = signal.signal(SIGNAL, give_up)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds, AGAIN)
    try:
        yield
    finally:
        _no_longer(before)


def _no_longer(before: signal.Handlers | Callable[..., object] | int | None) -> None:
    """Switch the limit off, even if the signal arrives again meanwhile."""
    while True:
        try:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
            signal.signal(SIGNAL, before)
            return
        except Undecided:
            continue


def undecidable(exercise: Exercise, seed: str) -> Verdict:
    """Return a verdict of zero points, which says that the subject's output is too long to judge."""
    diagnosis = Diagnosis(
        "undecidable",
        "Your program said and sent far too much: the judge could not finish reading it.",
        "Log what the task asks for, one short line for each thing that happens, and nothing else.",
    )
    return replace(failed(exercise.id, exercise.title, float(exercise.points), diagnosis), seed=seed)
