"""The limits that hold while a notebook runs, and how much of a time is left."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import dataclass

Left = Callable[[], float]
"""The seconds that are left; none or fewer at the end."""
Patient = Callable[[float], Left]
"""A function from a number of seconds to the time that is left of them, from the call on."""


@dataclass(frozen=True)
class Limits:
    """The limits of one notebook; where one is met, the feedback names it.

    Attributes:
        cell_seconds: Seconds that the machine has for one cell; where it is crowded, each lasts longer on the wall.
            A check cell gets its exercise's limit and ``check_margin`` instead.
        terminal_factor: How many times as long a terminal's cell (``%%bash``) may take: it may build.
        check_margin: Seconds beyond the judge's own limit, so that its verdict arrives before the cell is
            stopped.
        notebook_seconds: Wall time of all cells together, checks included.
        interrupt_grace: Seconds that an interrupted cell has to end before its kernel is killed.
        start_seconds: Wall time until a kernel must have answered.
        cell_output_bytes: Output kept of one cell; the rest is dropped and a line says so.
        notebook_output_bytes: Output kept of all cells together.
        message_bytes: Largest single message that is read from a kernel.
        flood_bytes: Output that a cell may send, kept or not, before it is stopped.
        cpu_seconds: Processor time of a box's processes together; a submission that is executed twice has it each time.
        memory_bytes: Memory of a box's processes together, files in its scratch included.
        beside_bytes: The same, as long as others are executed beside. Who needs more is executed again, alone, so it
            decides nothing.
        beside: Whether others are.
        judge_bytes: Memory that the judge's process, and each check of it, may write to: what a subject sends to it
            ends there.
        processes: Processes and threads of a box together.
        open_files: Files, sockets and pipes that one process may have open.
        all_open_files: What all processes of a box may have open together, and the number of sockets in its network.
        file_locks: Parts of files that all processes of a box may have locked together; a database locks five.
        socket_bytes: What may wait in the sockets of a box's network. The machine has one limit for those of all boxes;
            where that is used up, nobody's messages arrive any more.
        scratch_bytes: What a box's files may have together.
        scratch_files: How many files, folders and links a box may have.
    """

    # What honest notebooks need, and why these are several times that: docs/decisions.md, on limits.
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
        """Limits of a judge's process (setrlimit(2)): address space that can be written to, stacks of threads too."""
        return {"RLIMIT_DATA": self.judge_bytes}

    @property
    def longest(self) -> float:
        """Seconds of wall time after which a notebook is stopped, whatever it does."""
        return self.start_seconds + self.notebook_seconds + self.interrupt_grace

    @property
    def memory_now(self) -> int:
        """The memory that a box may have now, in bytes."""
        return min(self.memory_bytes, self.beside_bytes) if self.beside else self.memory_bytes


_MOST_OPEN_FILES = 1 << 20
"""More is never needed, and some systems allow a billion, which programs that go through all of them count up to."""


def raise_own() -> None:
    """Take as much as this user may have of what the system counts for each user and not for each process.

    How many descriptors a user may have on their way through sockets is decided by the limit on open files of whoever
    sends one (unix(7), ETOOMANYREFS), whoever else has sent the others. A box of the same user must never be able to
    have as many as the grader, so that the grader can always send another one.
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
    """The number of files that a process in a box may have open: at most half of what the grader may have."""
    own = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return wanted if own == resource.RLIM_INFINITY else min(wanted, own // 2)


def until(deadline: float) -> Left:
    """Until a moment on the monotonic clock."""
    return lambda: deadline - time.monotonic()


def wall_time(seconds: float) -> Left:
    """For so many seconds of wall time."""
    return until(time.monotonic() + seconds)


def first_of(*lefts: Left) -> Left:
    """Until the first of several is up."""
    return lambda: min(left() for left in lefts)
