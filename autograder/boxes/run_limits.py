"""The limits for running a notebook, and functions that tell how much time is left."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

Left = Callable[[], float]
"""A function that returns the seconds that are left; zero or less when the time is over."""
Patient = Callable[[float], Left]
"""A function that starts a time limit of so many seconds, and returns a function for the seconds that are left."""


class Ended(StrEnum):
    """How the execution of a cell ended."""

    DONE = "done"
    RAISED = "raised"
    TIMED_OUT = "timed_out"
    KERNEL_DIED = "kernel_died"
    OUT_OF_MEMORY = "out_of_memory"
    OUT_OF_CPU = "out_of_cpu"
    TOO_MANY_PROCESSES = "too_many_processes"
    TOO_MANY_FILES = "too_many_files"
    TOO_MANY_LOCKS = "too_many_locks"
    TOO_MUCH_OUTPUT = "too_much_output"
    NOT_RUN = "not_run"
    """The cell did not run, because the kernel had ended or the notebook's time was over."""


@dataclass(frozen=True)
class Limits:
    """The limits of one notebook, each of which the feedback names if it is reached.

    Attributes:
        cell_seconds: Time limit in seconds for one cell; on a busy machine it gets longer. A check cell has the limit
            of its exercise plus ``check_margin`` instead.
        terminal_factor: The factor by which the limit of a ``%%bash`` cell is longer: it may build a workspace.
        check_margin: Seconds beyond the limit of the exercise, so that the verdict arrives before the cell is stopped.
        notebook_seconds: Wall time in seconds for all cells together, including checks.
        interrupt_grace: Seconds for an interrupted cell to end before its kernel is killed.
        start_seconds: Wall time in seconds within which a kernel must have answered.
        cell_output_bytes: The maximum number of bytes kept of one cell's output. The rest is dropped, and a line in
            the output says so.
        notebook_output_bytes: The maximum number of bytes kept of all cells' output together.
        message_bytes: The maximum size of one output message; a larger one is dropped unread.
        flood_bytes: The number of bytes after which a cell is stopped for its output, kept or not.
        desk_bytes: Memory in bytes for the desk that reads a kernel's messages.
        cpu_seconds: Processor time in seconds for all processes of a box, in each execution of a submission.
        memory_bytes: Memory in bytes for all processes of a box, including the files that they write into memory.
        beside_bytes: The memory limit in bytes while other submissions run. A submission that needs more is executed
            again, alone, so this limit never decides a result.
        beside: True while other submissions run.
        judge_bytes: The memory limit in bytes for the judge's process and for each of its checks. The judge reaches it
            if a subject sends too much.
        processes: The maximum number of processes and threads of a box.
        open_files: The maximum number of open files, sockets and pipes of one process.
        all_open_files: The maximum number of open files, sockets and pipes of all processes of a box; also the maximum
            number of sockets in the box's network.
        file_locks: The maximum number of file parts that all processes of a box may lock; a database locks five.
        socket_bytes: The maximum number of bytes that may wait in the sockets of a box's network. This is needed
            because the machine has one limit for all boxes; if it is used up, no box receives messages any more.
        scratch_bytes: The maximum size in bytes of all files that the boxes write.
        scratch_files: The maximum number of these files, with folders and links.
    """

    # docs/decisions.md says how long notebooks take; these limits are several times as high as what they need.
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
    desk_bytes: int = 700_000_000
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
    def of_the_desk(self) -> dict[str, int]:
        """Limits of the process that reads a kernel's messages (setrlimit(2))."""
        return {"RLIMIT_DATA": self.desk_bytes, "RLIMIT_CORE": 1}

    @property
    def of_the_judge(self) -> dict[str, int]:
        """Limits for a judge's process (setrlimit(2)): writable address space, including the stacks of threads."""
        return {"RLIMIT_DATA": self.judge_bytes}

    @property
    def longest(self) -> float:
        """The longest time that a notebook can run before it is stopped, in seconds of wall time."""
        return self.start_seconds + self.notebook_seconds + self.interrupt_grace

    @property
    def memory_now(self) -> int:
        """The memory that a box may use at the moment, in bytes."""
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
"""The highest limit on open files that is set, even if the system allows more. With a billion, as some systems allow, a
program that loops over all possible descriptors would take too long.
"""


def raise_own() -> None:
    """Raise this process's limits, for resources that the system counts by user, to the most that the user may have.

    Descriptors that are being sent through sockets are counted for each user. A process can send no more of them if its
    user has as many in transit as this process may have open files (unix(7), ETOOMANYREFS). A box runs as the same user
    as the grader, so the grader's limit must be higher than a box can reach: otherwise a box could keep the grader from
    sending descriptors.
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


def wall_time(seconds: float) -> Left:
    """Start a time limit of this many seconds of wall time. Return a function that returns the seconds left."""
    deadline = time.monotonic() + seconds
    return lambda: deadline - time.monotonic()


def first_of(*lefts: Left) -> Left:
    """Return a function that returns the seconds left until the first of several time limits ends."""
    return lambda: min(left() for left in lefts)
