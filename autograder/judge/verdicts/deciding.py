"""A limit on the time in which the judge decides about a subject's words and messages.

What it looks at was written by a student, so there may be a text that keeps a criterion busy for ever. Thinking needs
nothing of the machine but a processor, so a limit on processor time says the same on a busy machine as on an idle one.
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
"""Seconds of processor time for one decision; a usual one takes a hundredth of a second."""
AGAIN = 0.05
"""Seconds of processor time after which a decision that has not ended is told so once more.

An exception that is raised within a destructor or a callback of the garbage collector is printed and forgotten.
"""
SURE = 1.0
"""Seconds of processor time from which it is the subject's words that keep the judge: it may be told to end then."""
SIGNAL = signal.SIGVTALRM
"""Ends a decision; a judge that is not deciding anything does not hear it."""


class Undecided(BaseException):
    """The judge did not come to a decision. No ``except Exception`` on the way may take it for something else."""


@contextlib.contextmanager
def limited(seconds: float = LIMIT) -> Iterator[None]:
    """Decide something within a limit.

    Args:
        seconds: Of processor time.

    Raises:
        Undecided: That was not enough, or whoever waits for the verdict has sent ``SIGNAL``. A decision that has
            hardly begun goes on then: it was late for another reason, and has no verdict rather than a wrong one.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only a main thread hears signals; judges decide in theirs
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
    """Switch the limit off, also where it strikes once more in that moment."""
    while True:
        try:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
            signal.signal(SIGNAL, before)
            return
        except Undecided:
            continue


def undecidable(exercise: Exercise, seed: str) -> Verdict:
    """Zero points with the reason: the subject's own words are in the way, and would be at every further try."""
    diagnosis = Diagnosis(
        "undecidable",
        "The judge looked at what your program said and sent, and came to no end: there is far too much of it.",
        "Log what the task asks for, one short line for each thing that happens, and nothing else.",
    )
    return replace(failed(exercise.id, exercise.title, float(exercise.points), diagnosis), seed=seed)
