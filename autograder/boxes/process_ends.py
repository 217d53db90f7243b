"""Ending a process with everything that it started, daemons included."""

from __future__ import annotations

import contextlib
import os
import time
from typing import TYPE_CHECKING, Any

import psutil

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path


def end_descendants(within: float = 3.0) -> int:
    """Kill every descendant of this process and reap it.

    Meant for a worker between two submissions, when nothing of its own is running and it adopts orphans
    (:mod:`autograder.parent_death`).

    Args:
        within: Seconds after which to give up; a process in an uninterruptible system call dies when that
            ends.

    Returns:
        How many processes were found.
    """
    seen: set[int] = set()
    deadline = time.monotonic() + within
    while time.monotonic() < deadline:
        alive = psutil.Process().children(recursive=True)
        if not alive:
            break
        seen.update(process.pid for process in alive if not _is_zombie(process))
        _kill(alive)
        # A killed process becomes our own child when its parent dies; there is no event for "one of these
        # ended".
        if not _reap():
            time.sleep(0.005)
    return len(seen)


def end_processes_in(folder: Path) -> None:
    """Kill what was started for a submission with its home in ``folder``, where its worker no longer can.

    Found by command line and by environment, which both are inherited unless somebody takes care to hide.

    Args:
        folder: A folder that no other process has in its command line or as its home.
    """
    own = os.getpid()
    _kill(
        process
        for process in psutil.process_iter(["cmdline", "environ"])
        if process.pid != own and _mentions(process.info, f"{folder}{os.sep}")
    )


def _mentions(info: Mapping[str, Any], folder: str) -> bool:
    home = (info["environ"] or {}).get("HOME", "")
    return home.startswith(folder) or any(folder in word for word in info["cmdline"] or ())


def _kill(processes: Iterable[psutil.Process]) -> None:
    processes = list(processes)
    # Stopped first, so that none can start another while the list is gone through.
    for process in processes:
        with contextlib.suppress(psutil.Error):
            process.suspend()
    for process in processes:
        with contextlib.suppress(psutil.Error):
            process.kill()


def _is_zombie(process: psutil.Process) -> bool:
    try:
        return process.status() == psutil.STATUS_ZOMBIE
    except psutil.Error:
        return True


def _reap() -> bool:
    """Reap all children that have ended; whether there were any."""
    reaped = False
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            reaped = True
    return reaped
