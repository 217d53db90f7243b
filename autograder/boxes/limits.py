"""The limits for running a notebook, and functions that tell how much of a time is left."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import dataclass

Left = Callable[[], float]
"""Returns the seconds that are left; zero or less when the time is up."""
Patient = Callable[[float], Left]
"""Turns a number of seconds into a function that returns how many of them are left, counted from the call on."""


@dataclass(frozen=True)
class Limits:
    """The limits of one notebook; the feedback names a limit that was reached.

    Attributes:
        cell_seconds: Seconds for one cell on an idle machine; on a busy machine they stretch. A check cell gets its
            exercise's limit and ``check_margin`` instead.
        terminal_factor: How many times this limit a terminal's cell (``%%bash``) gets, because it may build.
        check_margin: Seconds beyond the judge's own limit, so that the verdict arrives before the cell is stopped.
        notebook_seconds: Wall time of all cells together, checks included.
        interrupt_grace: Seconds that an interrupted cell has to end before its kernel is killed.
        start_seconds: Wall time until a kernel must have answered.
        cell_output_bytes: Output kept from one cell; the rest is dropped, and a line in the output tells so.
        notebook_output_bytes: Output kept from all cells together.
        message_bytes: The largest message that is read from a kernel.
        flood_bytes: Output that a cell may send, kept or not, before it is stopped.
        cpu_seconds: Processor time of a box's processes together, for each time that a submission is executed.
        memory_bytes: Memory of a box's processes together, including files in its scratch.
        beside_bytes: The limit on memory while other submissions run. A submission that needs more is executed again,
            alone, so this limit never decides a result.
        beside: True while other submissions run.
        judge_bytes: Memory that the judge's process, and each of its checks, may write to; it bounds what a subject
            can send to the judge.
        processes: Processes and threads of a box together.
        open_files: Open files, sockets and pipes of one process.
        all_open_files: The same for all processes of a box together; also the most sockets in its network.
        file_locks: Parts of files that all processes of a box may lock together; a database locks five.
        socket_bytes: Bytes that may wait in the sockets of a box's network. The machine has one limit for all boxes
            together; if that is used up, no box receives messages any more.
        scratch_bytes: The size of a box's files together.
        scratch_files: The number of files, folders and links in a box.
    """

    # The needs of honest notebooks, and why these limits are several times that: docs/decisions.md, on limits.
    cell_seconds: float = 60.0
    terminal_factor: float = 2.0
    check_margin: float = 10.0
    notebook_seconds: float = 900.0
    interrupt_grace: float = 3.0
    start_seconds: float = 60.0
    cell_output_bytes: int = 200_000
    notebook_output_bytes: int = 2_000_000
    message_bytes: int = 8_000_000
    flood_bytes: int = 50_000_000
    cpu_seconds: float = 200.0
    memory_bytes: int = 2_000_000_000
    beside_bytes: int = 400_000_000
    beside: bool = False
    judge_bytes: int = 1_000_000_000
    processes: int = 500
    open_files: int = 1024
    all_open_files: int = 6000
    file_locks: int = 1000
    socket_bytes: int = 100_000_000
    scratch_bytes: int = 1_000_000_000
    scratch_files: int = 100_000

    @property
    def of_the_judge(self) -> dict[str, int]:
        """Limits of a judge's process (setrlimit(2)): writable address space, including the stacks of threads."""
        return {"RLIMIT_DATA": self.judge_bytes}

    @property
    def longest(self) -> float:
        """The longest that a notebook can run before it is stopped, in seconds of wall time."""
        return self.start_seconds + self.notebook_seconds + self.interrupt_grace

    @property
    def memory_now(self) -> int:
        """The memory that a box may use now, in bytes."""
        return min(self.memory_bytes, self.beside_bytes) if self.beside else self.memory_bytes


BUILD_LIMITS = Limits(
    cpu_seconds=300.0,
    memory_bytes=1_500_000_000,
    beside_bytes=500_000_000,
    beside=True,
    processes=200,
    scratch_bytes=300_000_000,
    scratch_files=20_000,
)
"""The limits for the box of a build. An interface package takes 10 s of processor time and 400 MB of memory, and writes
5 million bytes in 600 files.
"""


_MOST_OPEN_FILES = 1 << 20
"""Programs that loop over all possible descriptors would take too long with the billion that some systems allow."""


def raise_own() -> None:
    """Raise this process's limits to the most that its user may have, for resources that the system counts by user.

    The number of descriptors that a user may have in transit through sockets is the sender's limit on open files
    (unix(7), ETOOMANYREFS), whichever process sent the others. A box of the same user must never be able to use as
    many as the grader, so that the grader can always send one more.
    """
    for kind, most in (
        (resource.RLIMIT_NOFILE, _MOST_OPEN_FILES),
        (resource.RLIMIT_NPROC, resource.RLIM_INFINITY),
        (resource.RLIMIT_SIGPENDING, resource.RLIM_INFINITY),
    ):
        soft, hard = resource.getrlimit(kind)
        wanted = hard if most == resource.RLIM_INFINITY else most
        if hard != resource.RLIM_INFINITY:
            wanted = min(wanted, hard)
        if soft != resource.RLIM_INFINITY and (wanted == resource.RLIM_INFINITY or wanted > soft):
            resource.setrlimit(kind, (wanted, hard))


def open_files_of_a_box(wanted: int) -> int:
    """Return how many files a process in a box may have open: at most half as many as the grader."""
    own = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return wanted if own == resource.RLIM_INFINITY else min(wanted, own // 2)


def until(deadline: float) -> Left:
    """Return the time left until a moment on the monotonic clock."""
    return lambda: deadline - time.monotonic()


def wall_time(seconds: float) -> Left:
    """Return the time left of ``seconds`` seconds of wall time from now on."""
    return until(time.monotonic() + seconds)


def first_of(*lefts: Left) -> Left:
    """Return the time left until the first of several ends."""
    return lambda: min(left() for left in lefts)
