"""Lists the descendants of a process, ends them together, and makes them end with their parent.

This works only on Linux (proc(5), prctl(2), pidfd_open(2)). A command that must end together with another process,
including everything that the command has started, is run as ``python -I -S process_trees.py PARENT COMMAND ...``
(:func:`keep`).
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    Known = tuple[int, str]
    """A process id and the start time of the process (:func:`_started_at`). If the system reuses the id for another
    process, the start time differs.
    """

_PR_SET_PDEATHSIG = 1  # linux/prctl.h
_PR_SET_DUMPABLE = 4
_PR_SET_CHILD_SUBREAPER = 36
# Load libc here, because loading a library between fork and exec is not safe.
_libc = ctypes.CDLL(None, use_errno=True)


def die_with_parent(parent: int = 0, number: signal.Signals = signal.SIGKILL) -> None:
    """Let the kernel send a signal to this process when its parent ends.

    If the parent has already ended, kill this process.

    The setting survives exec. Children do not inherit it, and it is lost if the process changes its user or group. For
    Linux, the parent is the *thread* that started this process, so that thread must live as long as this process.

    Args:
        parent: The process id of the parent, from before the fork; 0 if it is unknown or in another PID namespace. With
            0, this function does not notice that the parent has already ended.
        number: The number of the signal.
    """
    _prctl(_PR_SET_PDEATHSIG, number)
    if parent and os.getppid() != parent:
        os._exit(1)


def adopt_orphans() -> bool:
    """Make this process the parent of each descendant whose own parent ends, so that no descendant escapes.

    Returns:
        True if the system supports this. On systems other than Linux, a daemon may escape.
    """
    return _prctl(_PR_SET_CHILD_SUBREAPER, 1)


def descendants(pid: int) -> list[int]:
    """Return the ids of all running descendants of a process."""
    found: list[int] = []
    ahead = [pid]
    while ahead:
        below = _children(ahead.pop())
        found += below
        ahead += below
    return found


def known(processes: Iterable[int]) -> set[Known]:
    """Return processes with their start times, so that no signal reaches a later process with the same id."""
    return {(pid, _started_at(pid)) for pid in processes}


def _send(processes: Iterable[Known], number: int) -> None:
    """Send a signal to the given processes. Skip processes that have ended."""
    for process in processes:
        _signal(process, number)


def kill(processes: Iterable[Known]) -> None:
    """Kill processes that may be starting other processes.

    All of them are stopped first, so that none can start another process meanwhile.
    """
    processes = list(processes)
    for number in (signal.SIGSTOP, signal.SIGKILL):
        _send(processes, number)


def end_each(processes: Iterable[int], number: int, within: float) -> None:
    """Send a signal to one process after the other, and wait each time until that process has ended.

    Args:
        processes: The processes to end, in order.
        number: The signal.
        within: The maximum number of seconds to wait for all processes together. After that, the others get the signal
            without a wait.
    """
    deadline = time.monotonic() + within
    for process in [(pid, _started_at(pid)) for pid in processes]:
        _signal(process, number, max(0.0, deadline - time.monotonic()))


def signal_group(leader: int, number: int) -> None:
    """Send a signal to a process group if it still exists. For 0, the caller's own group, do nothing."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        if leader > 0:
            os.killpg(leader, number)


def end_soon(process: subprocess.Popen[bytes], within: float) -> None:
    """Wait for a child that was asked to end. If it does not end in time, kill it.

    Args:
        process: The child process.
        within: The maximum number of seconds to wait.
    """
    try:
        process.wait(within)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def end_descendants(within: float = 3.0) -> int:
    """Kill every descendant of this process, and wait for those that are, or become, its children.

    Call this only in a process that adopts orphans, at a time when it needs none of its children.

    Args:
        within: The limit in seconds. A process in an uninterruptible system call dies only when that call ends.

    Returns:
        The number of processes that were found.
    """
    seen: set[int] = set()
    deadline = time.monotonic() + within
    while time.monotonic() < deadline:
        children = _children(os.getpid())
        if not children:
            break
        alive = [*children, *(below for child in children for below in descendants(child))]
        seen.update(pid for pid in alive if _lives(pid))
        kill(known(alive))
        # When the parent of a killed process dies, the killed process becomes a child of this process. No event reports
        # when these processes have ended, so this code polls.
        if not _reap(children):
            time.sleep(0.005)
    return len(seen)


def end_below(pid: int) -> None:
    """Kill every descendant of a process that adopts orphans, and wait until they have ended.

    Descendants that are started meanwhile are killed, too.

    Processes that this process is not allowed to kill, because another user runs them, are left.

    Args:
        pid: The id of the process that adopts orphans. It is not killed.
    """
    left: set[Known] = set()
    while living := known(one for one in descendants(pid) if _lives(one)) - left:
        _send(living, signal.SIGSTOP)
        left |= {process for process in living if not _signal(process, signal.SIGKILL)}
        # The first process of a sandbox can end only after all processes of the sandbox were waited for
        # (pid_namespaces(7)). Some were started from outside, and their parent has ended: they are now children of this
        # process, which waits for them here.
        if pid != os.getpid() or not _reap(_children(pid)):
            time.sleep(0.005)


def keep(parent: int, command: list[str]) -> int:
    """Run a command, and end it with all its descendants when the parent ends or this process gets SIGTERM.

    Processes that the command leaves behind are ended, too. Ctrl-C reaches the command but not this process.

    Args:
        parent: The id of the process that started this one.
        command: The program and its arguments.

    Returns:
        The exit code of the command; negative if a signal ended it.
    """
    adopt_orphans()
    parent_ends = os.pidfd_open(parent)
    if (
        os.getppid() != parent
    ):  # the parent has ended, and another process may now have the parent's process id
        return 1
    signaled, on_signal = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
    signal.set_wakeup_fd(on_signal, warn_on_full_buffer=False)
    for number in (signal.SIGCHLD, signal.SIGTERM, signal.SIGINT):
        # Use a handler that does nothing, because the command would inherit SIG_IGN, but inherits no handler.
        signal.signal(number, lambda *_: None)
    child = _start(command)
    code: int | None = None
    try:
        while code is None:
            ready, _, _ = select.select([parent_ends, signaled], [], [])
            if parent_ends in ready or signal.SIGTERM in os.read(signaled, 1 << 12):
                return -signal.SIGKILL
            code = reaped(child)
        return code
    finally:
        end_below(os.getpid())


def _start(command: list[str]) -> int:
    """Start the command with only its standard streams open. Return its process id."""
    keeper = os.getpid()
    child = os.fork()
    if child == 0:
        try:
            die_with_parent(keeper)
            # Python ignores these signals, but the command must start with their default action.
            for number in (signal.SIGPIPE, signal.SIGXFSZ):
                signal.signal(number, signal.SIG_DFL)
            os.closerange(3, os.sysconf("SC_OPEN_MAX"))
            os.execvp(command[0], command)
        except OSError as error:
            os.write(2, f"{command[0]}: {error.strerror}\n".encode())
        finally:
            os._exit(127)
    return child


def reaped(wanted: int) -> int | None:
    """Reap all children that have already ended (waitpid(2)).

    Return the exit code of the wanted child; None if that child still runs or was reaped earlier.
    """
    code: int | None = None
    with contextlib.suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0]:
            if ended[0] == wanted:
                code = os.waitstatus_to_exitcode(ended[1])
    return code


def end_processes_in(folder: Path) -> None:
    """Kill the processes of submissions whose homes are below ``folder``, if the executor process can no longer do so.

    A process is found by its command line or by its environment, which a process inherits from its parent. So a program
    that hides its environment on purpose is not found.

    Args:
        folder: A folder that no process of another submission has in its command line or as its home.
    """
    place = os.fsencode(f"{folder}{os.sep}")
    kill(known(pid for pid in _processes() if pid != os.getpid() and _mentions(pid, place)))


def _signal(process: Known, number: int, within: float = 0.0) -> bool:
    """Send a signal to a process if it still exists, and wait at most ``within`` seconds for it to end.

    Only one pidfd is open at a time, because there may be more processes than the limit of open files.

    Returns:
        False if this process is not allowed to send it a signal.
    """
    pid, began = process
    with contextlib.suppress(ProcessLookupError):
        handle = os.pidfd_open(pid)
        try:
            if began and _started_at(pid) == began:
                signal.pidfd_send_signal(handle, number)
                # poll(2) is used because select(2) does not support the high descriptors of a grader with many open
                # files.
                waiting = select.poll()
                waiting.register(handle, select.POLLIN)
                waiting.poll(within * 1000)
        except PermissionError:
            return False
        finally:
            os.close(handle)
    return True


def _lives(pid: int) -> bool:
    """Return True if a process exists and is not a zombie."""
    return _fields(pid)[:1] not in ([], ["Z"], ["X"])


def _children(pid: int) -> list[int]:
    found: list[int] = []
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            with contextlib.suppress(OSError):  # One of several threads may end meanwhile.
                found += map(int, (task / "children").read_text().split())
    return found


def _processes() -> list[int]:
    return [int(name) for name in os.listdir("/proc") if name.isdecimal()]  # noqa: PTH208


def _fields(pid: int) -> list[str]:
    """Return the fields of a process's ``stat`` file, beginning with its state; none if the process has ended."""
    try:
        # The fields come after the name of the program, which may contain anything (proc(5)).
        return Path(f"/proc/{pid}/stat").read_text(errors="replace").rpartition(")")[2].split()
    except OSError:
        return []


def _started_at(pid: int) -> str:
    """Return the start time of a process, in clock ticks since the system started; empty if the process has ended."""
    fields = _fields(pid)
    return fields[19] if fields else ""


def _mentions(pid: int, place: bytes) -> bool:
    """Return True if a process has a folder in its command line, or has its home there."""
    with contextlib.suppress(OSError):
        if place in Path(f"/proc/{pid}/cmdline").read_bytes():
            return True
        variables = Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
        return any(variable.startswith(b"HOME=" + place) for variable in variables)
    return False


def _reap(children: Iterable[int]) -> bool:
    """Reap the given children that have already ended (waitpid(2)). Return True if there were any."""
    reaped = False
    for child in children:
        with contextlib.suppress(ChildProcessError):
            reaped = os.waitpid(child, os.WNOHANG)[0] != 0 or reaped
    return reaped


def _prctl(option: int, value: int) -> bool:
    if sys.platform != "linux":
        return False
    return bool(_libc.prctl(option, *map(ctypes.c_ulong, (value, 0, 0, 0))) == 0)


def _end_as(code: int) -> None:
    """End this process with an exit code. A code of -N means: end by signal N, without a core file."""
    if code < 0:
        _prctl(_PR_SET_DUMPABLE, 0)
        signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    sys.exit(code)


if __name__ == "__main__":
    _end_as(keep(int(sys.argv[1]), sys.argv[2:]))
