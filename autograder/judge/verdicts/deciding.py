"""Limits the time that the judge takes to decide about a subject's output and messages.

A student's program wrote that output, so it may keep a criterion busy forever. Deciding needs only a processor, so a
limit on processor time has the same effect on a busy machine as on an idle one.
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
"""The limit in seconds of processor time for one decision; it usually takes a hundredth of a second."""
AGAIN = 0.05
"""Seconds of processor time after which the signal is sent again if the decision has not ended.

This is needed because Python prints and drops an exception that is raised in a destructor or in a callback of the
garbage collector.
"""
SURE = 1.0
"""Seconds of processor time. A decision that has taken longer is delayed by the subject's output, not by the machine.
"""
SIGNAL = signal.SIGVTALRM
"""The signal that ends a decision. A judge that is not deciding ignores it."""


class Undecided(BaseException):
    """The judge did not reach a decision. Must not be caught by ``except Exception``."""


@contextlib.contextmanager
def limited(seconds: float = LIMIT) -> Iterator[None]:
    """Run the block within a limit of processor time.

    Args:
        seconds: Limit in seconds of processor time.

    Raises:
        Undecided: The time is over, or the parent process has sent ``SIGNAL``. A decision that has only just begun
            ignores the signal, because then the check is late for another reason, and no verdict is better than a
            wrong one.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread receives signals, so judges decide in it
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
    """Return a verdict of zero points: the subject's output is too long to decide about, now and in any later check."""
    diagnosis = Diagnosis(
        "undecidable",
        "Your program said and sent far too much: the judge could not finish reading it.",
        "Log what the task asks for, one short line for each thing that happens, and nothing else.",
    )
    return replace(failed(exercise.id, exercise.title, float(exercise.points), diagnosis), seed=seed)
