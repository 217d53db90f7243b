"""Keeps a new DDS participant from losing the answers to its first announcement, and recognizes unnamed nodes.

Fast DDS 2.14 announces a new participant before it has registered the participant's receivers. Existing participants
answer within 0.1 ms, and only once. If a receiving thread reads such an answer too early, the answer is lost, and the
next one comes with the periodic announcement, up to 3 s later. One new participant in three was discovered that late.
So the threads of a new participant must not run before the thread that makes them has finished.
"""

from __future__ import annotations

import contextlib
import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

UNNAMED = "_NODE_"
"""The beginning of the name that a participant reports for a node whose real name it does not know yet
(rmw_dds_common).
"""


@contextlib.contextmanager
def receivers_wait() -> Iterator[None]:
    """Return a context manager: threads that are started in its block run only after the block has ended.

    The threads and the thread that starts them share one processor, under a scheduling policy that does not interrupt a
    running thread (sched(7), SCHED_BATCH). If the operating system has no such policy, this has no effect.
    """
    if not hasattr(os, "SCHED_BATCH"):
        yield
        return
    processors, policy, priority = os.sched_getaffinity(0), os.sched_getscheduler(0), os.sched_getparam(0)
    before = _threads()
    with contextlib.suppress(OSError):
        os.sched_setaffinity(0, {max(processors)})
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    try:
        yield
    finally:
        for thread in (_threads() - before) | {threading.get_native_id()}:
            with contextlib.suppress(OSError):  # A thread may have ended meanwhile.
                os.sched_setaffinity(thread, processors)
                os.sched_setscheduler(thread, policy, priority)


def _threads() -> set[int]:
    return {int(entry.name) for entry in Path("/proc/self/task").iterdir()}
