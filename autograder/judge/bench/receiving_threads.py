"""Waits until the middleware's threads have processed every message that has arrived.

The judge learns of a program's end through a pipe, but of the program's messages through threads of the middleware. So
on a busy machine, the judge may learn of the end while such a thread, woken by a message, still waits for a processor.
This module therefore waits until each thread that is awake has gone to sleep. A sleeping thread has no message left,
because a message wakes its thread at once (futex(7), udp(7)).
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.judge.bench.patience import Patience

PAUSE = 0.001
"""Seconds between two checks of a thread."""
TURNS = 2
"""The number of rounds to wait. In the first round, a thread may finish its work and wake another thread. The second
round waits for that thread.
"""


@dataclass(frozen=True)
class _Thread:
    """The state of a thread, as the kernel reports it (proc_pid_status(5)).

    Attributes:
        awake: True if the thread runs, or waits for a processor.
        slept: The number of times that the thread has gone to sleep.
    """

    awake: bool
    slept: int


def await_turns(patience: Patience) -> bool:
    """Wait until each thread of the middleware that is awake has slept once. Return False if the time is up first."""
    return all(_await_turn(patience) for _ in range(TURNS))


def _await_turn(patience: Patience) -> bool:
    pause = threading.Event()
    python = {thread.native_id for thread in threading.enumerate()}
    tasks = (int(task.name) for task in Path("/proc/self/task").iterdir())
    awake = {task: thread for task, thread in _look(set(tasks) - python).items() if thread.awake}
    while awake and patience.left > 0:
        pause.wait(PAUSE)
        now = _look(awake)
        awake = {
            task: thread
            for task, thread in awake.items()
            if task in now and now[task].awake and now[task].slept == thread.slept
        }
    return not awake


def _look(tasks: Iterable[int]) -> dict[int, _Thread]:
    """Return the states of these threads, without those that have ended."""
    found: dict[int, _Thread] = {}
    for task in tasks:
        try:
            lines = Path(f"/proc/self/task/{task}/status").read_text().splitlines()
        except OSError:  # the thread has ended meanwhile
            continue
        told = dict(line.split(":", 1) for line in lines)
        found[task] = _Thread(told["State"].split()[0] in "RD", int(told.get("voluntary_ctxt_switches", 0)))
    return found
