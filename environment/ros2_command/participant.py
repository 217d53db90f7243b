"""Create a node that hears the answers to its own first announcement.

Fast DDS (2.14) announces a new participant before it has registered who receives. A participant that was
there already answers within 0.1 ms, once; if the receiving thread reads that answer too early it is dropped,
and the next one is the periodic announcement, up to 3 s later. Measured with two processes on one machine:
one new participant in three waited 0.5 to 2.8 s. So the threads of a new participant must not run before the
one that creates them is done: they are kept on its CPU, under a scheduling policy that never interrupts a
running thread. With that, 0.13 s was usual and 0.39 s the longest of all runs.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_THREADS = Path("/proc/self/task")


@contextlib.contextmanager
def threads_wait_for_creator() -> Iterator[None]:
    """Keep the threads that are started inside from interrupting the one that starts them.

    Does nothing where the operating system has no such policy (it is Linux's).
    """
    if not hasattr(os, "SCHED_BATCH"):
        yield
        return
    cpus, policy, priority = os.sched_getaffinity(0), os.sched_getscheduler(0), os.sched_getparam(0)
    before = _thread_ids()
    try:
        with contextlib.suppress(OSError):
            os.sched_setaffinity(0, {max(cpus)})
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
        yield
    finally:
        for thread in (_thread_ids() - before) | {0}:
            # A thread may have ended since it was listed.
            with contextlib.suppress(OSError):
                os.sched_setaffinity(thread, cpus)
                os.sched_setscheduler(thread, policy, priority)


def _thread_ids() -> set[int]:
    try:
        return {int(entry.name) for entry in _THREADS.iterdir()}
    except OSError:
        return set()
