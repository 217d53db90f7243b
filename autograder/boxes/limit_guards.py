"""Guards that enforce a box's limits: cgroups if the host allows them, otherwise regular checks of the processes.

With cgroups, the operating system itself refuses or ends a process at a limit. Without cgroups, this guard checks the
box's ``/proc`` several times a second, and ends a box that exceeds a limit. A program may exceed a limit faster than it
is checked, so each single process also has limits of its own, which the operating system enforces. The checks also read
the largest amount of memory that a process ever had, so the verdict is the same whichever limit a process reaches
first. The limit on processor time is always enforced by checks, even with cgroups, because a box that exceeds it for a
moment harms nothing.
"""

from __future__ import annotations

import fcntl
import os
import resource
import select
import socket
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import re2

from autograder.boxes.cgroups import Group, usable
from autograder.boxes.run_limits import Ended, open_files_of_a_box

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.boxes.run_limits import Limits


INTERVAL = 0.25
"""Seconds between two checks."""
_SIZE = re2.compile(r"(?m)^(\w+):[ \t]+(\d+) kB$")
_TICKS = os.sysconf("SC_CLK_TCK")
_ZOMBIE = "Z"
_SMALL_PIPE = 8192
"""The size in bytes of a new pipe once a user's pipes have reached ``/proc/sys/fs/pipe-user-pages-soft`` (pipe(7))."""
_PAGES = re2.compile(r"(?m)^(?:TCP|UDP): .*\bmem (\d+)$")
"""Matches, in ``/proc/net/sockstat``, the memory of data that waits in sockets: of all networks together, in pages. The
numbers include sockets of IPv6 and of UDP-Lite.
"""
_PROTOCOLS = ("udp", "udp6", "tcp", "tcp6")
_SOCKETS = re2.compile(r"(?m)^sockets: used (\d+)$")
_PIECE = 1 << 16


_used_up_at = 0.0
"""The time (``time.monotonic``) at which a guard of this process last saw that its user's counters were used up."""


class BoxGuard:
    """Enforces the limits on the boxes of one submission. Call :meth:`close` after the boxes have ended."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._group = Group(limits.memory_now, limits.processes)
        self._memory, self._processes = ("memory" in usable(), "pids" in usable())
        self._first = 0
        self._next_look = 0.0
        self._seen: Ended | None = None
        self._seen_cpu = 0.0
        self._had_room = self._has_room()
        self._began = time.monotonic()

    @property
    def cgroups(self) -> list[str]:
        """The files into which a process writes 0, to join the cgroups, before it enters a box."""
        return self._group.procs

    @property
    def hidden_memory(self) -> bool:
        """True if the box may use memory that belongs to no process, because a cgroup counts that memory, too."""
        return self._memory

    @property
    def rlimits(self) -> Mapping[str, int]:
        """Limits on each single process (setrlimit(2))."""
        limits = {
            "RLIMIT_CORE": 1,  # with 0, the system would still start a handler of core dumps (core(5))
            "RLIMIT_NOFILE": open_files_of_a_box(self._limits.open_files),
            "RLIMIT_FSIZE": self._limits.scratch_bytes,
            "RLIMIT_CPU": int(self._limits.cpu_seconds) + 1,
            "RLIMIT_MSGQUEUE": 1_000_000,
            "RLIMIT_MEMLOCK": 1 << 23,
            "RLIMIT_SIGPENDING": 1000,
        }
        if not self._memory:
            # This limits writable address space, including the stacks of threads. The limit is twice that on memory,
            # because address space is always larger than the memory in use.
            limits["RLIMIT_DATA"] = 2 * self._limits.memory_bytes
        if not self._processes and os.geteuid() != 0:
            limits["RLIMIT_NPROC"] = self._limits.processes
        return limits

    def watch(self, first: int) -> None:
        """Start checking the processes of a box.

        Args:
            first: The PID of the box's first process, as seen from outside the box.
        """
        self._first = first

    def exceeded(self, *, at_once: bool = False) -> Ended | None:
        """Return the limit that the last check found exceeded, or None. The caller must end a box that exceeds a limit.

        Args:
            at_once: True to check again now, unless a cgroup limits the memory. Otherwise this method checks again
                only if the last check is older than ``INTERVAL`` seconds.
        """
        now = time.monotonic()
        due = now >= self._next_look or (at_once and not self._memory)
        if self._seen is None and self._first and due:
            self._next_look = now + INTERVAL
            self._seen = self._look()
        return self._seen

    def reason(self) -> Ended | None:
        """The limit that was exceeded, or at which the system refused or killed a process; None if there is none."""
        if self._seen is None and self._group.ran_out_of_memory:
            return Ended.OUT_OF_MEMORY
        if self._seen is None and self._group.ran_out_of_processes:
            return Ended.TOO_MANY_PROCESSES
        return self._seen

    @property
    def cpu_seconds(self) -> float:
        """The processor time used until now, in seconds; without a cgroup, until the last check."""
        counted = self._group.cpu_seconds
        return self._seen_cpu if counted is None else counted

    def close(self) -> None:
        """Remove the cgroups. This may be called twice."""
        self._first = 0
        self._group.close()

    def _has_room(self) -> bool:
        """Return False if this user has used up a limit that Linux counts for all processes of a user together.

        The limit on large pipes is asked about only while other submissions run, because then waiting helps. A
        submission that runs alone is run even without large pipes: otherwise it would get no points only because
        another program of the user has them.
        """
        return _can_watch() and (not self._limits.beside or _can_make_large_pipes())

    def _look(self) -> Ended | None:
        global _used_up_at
        # Memory was used up if the kernel killed any process of the group, whichever process it chose.
        if self._group.ran_out_of_memory:
            return Ended.OUT_OF_MEMORY
        if self._had_room and not self._has_room():
            _used_up_at = time.monotonic()
        # Any of the boxes may be the cause, and calls in the others may have failed. So all end, and run again alone.
        if self._had_room and _used_up_at > self._began:
            return Ended.OUT_OF_MEMORY
        use = use_of(self._first, None if self._memory else _memory_of)
        self._seen_cpu = max(self._seen_cpu, use.cpu_seconds)
        if self.cpu_seconds > self._limits.cpu_seconds:
            return Ended.OUT_OF_CPU
        # Threads are checked before open files, because each forked process also has the open files of its parent.
        if not self._processes and use.threads > self._limits.processes:
            return Ended.TOO_MANY_PROCESSES
        if use.files > self._limits.all_open_files:
            return Ended.TOO_MANY_FILES
        sockets, waiting = _network_of(self._first, self._limits.socket_bytes)
        if sockets > self._limits.all_open_files:
            return Ended.TOO_MANY_FILES
        if waiting > self._limits.socket_bytes:
            return Ended.OUT_OF_MEMORY
        if _locks_of(self._first, self._limits.file_locks) > self._limits.file_locks:
            return Ended.TOO_MANY_LOCKS
        if use.most_memory > self._limits.memory_now:
            return Ended.OUT_OF_MEMORY
        files = 0 if self._memory else _scratch_of(self._first)
        if use.memory + files > self._limits.memory_now:
            # The quick measurement counts shared memory several times, so measure exactly before ending the box.
            exactly = use_of(self._first, _exact_memory_of)
            return Ended.OUT_OF_MEMORY if exactly.memory + files > self._limits.memory_now else None
        return None


def _can_watch() -> bool:
    """Return True if an epoll instance of this user can watch one more file (epoll(7), ``max_user_watches``)."""
    try:
        with select.epoll() as watcher, socket.socket(socket.AF_UNIX) as watched:
            watcher.register(watched)
    except OSError:
        return False
    return True


def _can_make_large_pipes() -> bool:
    """Return True if a new pipe of this user has its usual size."""
    ends = os.pipe()
    try:
        return fcntl.fcntl(ends[0], fcntl.F_GETPIPE_SZ) > _SMALL_PIPE
    finally:
        for end in ends:
            os.close(end)


@dataclass(frozen=True)
class Use:
    """The resources that the processes of a box use together.

    Attributes:
        threads: The number of threads, of which each process has at least one.
        memory: Memory in bytes that belongs to no file; 0 if it was not measured.
        most_memory: The largest memory in bytes that any single process had at any time.
        cpu_seconds: Processor time in seconds, including that of children that have ended and were waited for.
        files: The number of open files, sockets and pipes. They are limited because data that waits in them, and event
            watches on them, take memory that belongs to no process.
    """

    threads: int
    memory: int
    most_memory: int
    cpu_seconds: float
    files: int


_NOTHING = Use(0, 0, 0, 0.0, 0)
_MemoryOf = Callable[[str], tuple[int, int]]
"""A function that returns the memory of the process with this ``/proc`` folder, in bytes: now, and the largest until
now.
"""


def use_of(first: int, memory_of: _MemoryOf | None) -> Use:
    """Measure the resources of all processes in a PID namespace.

    Args:
        first: The PID, as seen from the host, of the first process in the namespace. Its ``/proc`` shows the others.
        memory_of: Measures the memory of a process; None to skip memory.
    """
    threads = memory = most_memory = files = 0
    seconds = 0.0
    try:
        own = f"/proc/{first}/root/proc"
        if Path(own).stat().st_dev == Path("/proc").stat().st_dev:
            return _NOTHING  # the process is about to enter the box and still sees the processes of the host
        processes = [entry for entry in os.scandir(own) if entry.name.isdecimal()]
    except OSError:
        return _NOTHING
    for process in processes:
        try:
            # The fields come after the name of the program, which may contain any character (proc(5)).
            fields = Path(process.path, "stat").read_text(errors="replace").rpartition(")")[2].split()
            threads += int(fields[17])
            seconds += sum(map(int, fields[11:15])) / _TICKS
            folder = process.path
            if fields[0] == _ZOMBIE and int(fields[17]) > 1:
                # The first thread has ended. Only the folders of the others show the memory and files of the process.
                folder = max(os.scandir(f"{folder}/task"), key=lambda thread: int(thread.name)).path
            now, most = memory_of(folder) if memory_of else (0, 0)
            memory += now
            most_memory = max(most_memory, most)
            files += _files_of(folder)
        except (OSError, ValueError, IndexError):
            continue  # the process has ended meanwhile
    return Use(threads, memory, most_memory, seconds, files)


def _files_of(process: str) -> int:
    """Return the number of files that a process has open.

    Since Linux 6.2, this number is the size of the folder ``fd`` (proc_pid_fd(5)). In earlier versions the size is 0,
    so the entries of the folder are counted.
    """
    folder = f"{process}/fd"
    return os.stat(folder).st_size or len(os.listdir(folder))  # noqa: PTH116, PTH208 (several times a second)


def _network_of(first: int, most: int) -> tuple[int, int]:
    """Count the sockets of a box's network, and the bytes that wait in them (proc_pid_net(5)).

    They belong to no process, and often to no cgroup. Sockets that no process has open count, too: a connection has no
    descriptor until the listening program accepts it.

    Args:
        first: The PID of the box's first process, as seen from the host.
        most: The maximum number of waiting bytes that is allowed. If all networks of the machine together have no more
            than this, the UDP and TCP tables are not read, because reading them takes ten milliseconds.
    """
    net = Path(f"/proc/{first}/net")
    sockets = waiting = 0
    try:
        if Path(f"/proc/{first}/ns/net").stat().st_ino == Path("/proc/self/ns/net").stat().st_ino:
            return 0, 0  # the process is about to enter the box
        summary = (net / "sockstat").read_text()
        sockets = sum(map(int, _SOCKETS.findall(summary)))
        pages = sum(map(int, _PAGES.findall(summary)))
        for protocol in _PROTOCOLS if pages * resource.getpagesize() > most else ():
            for fields in _rows(net / protocol):
                sent, _, received = fields[4].partition(":")
                waiting += int(sent, 16) + int(received, 16)
        waiting += sum(int(fields[4]) + int(fields[5]) for fields in _rows(net / "netlink"))
    except (OSError, ValueError, IndexError):
        pass  # the process has ended meanwhile
    return sockets, waiting


def _locks_of(first: int, most: int) -> int:
    """Count the file locks that the processes of a box hold or wait for, because no other limit covers their memory.

    A box's ``/proc/locks`` shows the locks of the box's processes. It also shows, with -1 as the PID, all locks of the
    whole machine that belong to an open file instead of a process. These are not counted, because no process in a box
    can make such a lock (:mod:`autograder.boxes.seccomp_filter`).

    Args:
        first: The PID of the box's first process, as seen from the host.
        most: Reading stops above this number of locks, because the kernel's time grows with the square of the number.
    """
    locks, rest = 0, b""
    try:
        own = Path(f"/proc/{first}/root/proc")
        if own.stat().st_dev == Path("/proc").stat().st_dev:
            return 0  # the process is about to enter the box
        with (own / "locks").open("rb", buffering=0) as table:
            while locks <= most and (piece := table.read(_PIECE)):
                *rows, rest = (rest + piece).split(b"\n")
                locks += sum(b" -1 " not in row for row in rows)
    except OSError:
        pass  # the process has ended meanwhile
    return locks


def _rows(table: Path) -> list[list[str]]:
    """Return the fields of each line below the heading; none if the system does not have the protocol."""
    return [line.split() for line in table.read_text().splitlines()[1:]] if table.exists() else []


def _scratch_of(first: int) -> int:
    """Return the size in bytes of the files that a box has written, which are in memory but belong to no process."""
    try:
        inside, outside = (os.statvfs(place) for place in (f"/proc/{first}/root/tmp", "/tmp"))
    except OSError:
        return 0
    return 0 if inside.f_fsid == outside.f_fsid else (inside.f_blocks - inside.f_bfree) * inside.f_frsize


def _memory_of(process: str) -> tuple[int, int]:
    """Measure the memory of a process. Memory shared by forks counts in each of them, and page tables count as well.

    ``VmHWM`` is the most memory that a process has had since it was forked or became another program, including pages
    of files (proc_pid_status(5)).
    """
    sizes = _sizes_in(Path(process, "status"))
    now = sizes["RssAnon"] + sizes["RssShmem"] + sizes["VmPTE"]
    return now, max(now, sizes["VmHWM"] - sizes["RssFile"])


def _exact_memory_of(process: str) -> tuple[int, int]:
    """Measure the memory of a process exactly: pages that several processes share are divided among them.

    The kernel needs more time for this than for :func:`_memory_of`.
    """
    try:
        sizes = _sizes_in(Path(process, "smaps_rollup"))
    except PermissionError:
        # The process is hidden (PR_SET_DUMPABLE, prctl(2)), so its shared pages have to be counted in full.
        return _memory_of(process)
    now = sizes["Pss_Anon"] + sizes["Pss_Shmem"] + _sizes_in(Path(process, "status"))["VmPTE"]
    return now, now


def _sizes_in(file: Path) -> Counter[str]:
    """Return the sizes in bytes in a file such as /proc/PID/status, by the name of the field; 0 for a missing field.

    Only whole lines such as ``VmPTE: 64 kB`` are read, because the file also contains the process's name, which the
    process chooses itself and which could imitate a field.
    """
    return Counter({name: int(size) * 1024 for name, size in _SIZE.findall(file.read_text(errors="replace"))})


class NoGuard:
    """The guard for execution without a box. It measures nothing, so only the time limits apply."""

    cpu_seconds = 0.0

    def exceeded(self, *, at_once: bool = False) -> Ended | None:  # noqa: ARG002  (as of BoxGuard)
        """Return None, because nothing is measured."""
        return None

    def reason(self) -> Ended | None:
        """None, because nothing is measured."""
        return None
