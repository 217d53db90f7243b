"""Watches the processes that a launch starts, and reports their command lines to the check."""

from __future__ import annotations

import contextlib
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import process_trees
from autograder.kit.output.launched_processes import Process, process_line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


LOOK_EVERY = 0.05
"""Seconds between two scans of the launch's processes."""
MAX_COMMAND_LINE = 32_000
"""The maximum number of bytes read of a command line. It is needed because a process can make its own command line
megabytes long, and change it before each scan.
"""
MAX_COMMAND_LINES = 500
"""The maximum number of command lines to report for one launch; a usual launch has about ten."""


@contextlib.contextmanager
def watched(pid: int, report: Callable[[str], None]) -> Iterator[None]:
    """Watch all descendants of a process, in a thread, until the ``with`` block ends.

    Args:
        pid: The id of the process whose descendants are watched.
        report: Called once for each process and command line, with the line for the check's report.
    """
    ended = threading.Event()
    watcher = threading.Thread(target=_watch, args=(pid, ended, report), daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()


def _watch(pid: int, ended: threading.Event, report: Callable[[str], None]) -> None:
    """Report each descendant of a process once for each of its command lines, until ``ended`` is set."""
    known: set[tuple[int, tuple[str, ...]]] = set()
    while not ended.wait(LOOK_EVERY):
        for child in process_trees.descendants(pid):
            argv = tuple(_arguments_of(child))
            if argv and (child, argv) not in known and len(known) < MAX_COMMAND_LINES:
                known.add((child, argv))
                parent = int((_status(child, "PPid") or ["0"])[0])
                report(process_line(Process(_own_id(child), _own_id(parent), argv)))


def _arguments_of(pid: int) -> list[str]:
    """Return the arguments with which a process was started; empty if it has ended."""
    try:
        with Path(f"/proc/{pid}/cmdline").open("rb", buffering=0) as file:
            words = file.read(MAX_COMMAND_LINE).rstrip(b"\0")
    except OSError:
        return []
    return [word.decode("utf-8", "replace") for word in words.split(b"\0")] if words else []


def _own_id(pid: int) -> int:
    """Return a process's id in its own PID namespace; 0 if the process has ended."""
    return int((_status(pid, "NSpid") or ["0"])[-1])


def _status(pid: int, name: str) -> list[str]:
    """Return the words in a line of ``/proc/PID/status`` (proc(5)); empty if the line does not exist."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return []
    return next((line.split()[1:] for line in lines if line.startswith(f"{name}:")), [])
