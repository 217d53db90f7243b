"""The processes of a launch, as a check of the launch is told of them."""

from __future__ import annotations

import contextlib
import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.kit.launch_report import Process, process_line
from autograder.process_trees import descendants

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

LOOK_EVERY = 0.05
"""Seconds between two looks at the launch's processes."""
MAX_COMMAND_LINE = 32_000
"""Bytes of a command line that are read: a process can give itself one of megabytes, and another one at each look."""
MAX_COMMAND_LINES = 500
"""Command lines that are reported of one launch, which has some ten."""


def _arguments_of(pid: int) -> list[str]:
    """The words that a process was started with; none where it is gone."""
    try:
        with Path(f"/proc/{pid}/cmdline").open("rb", buffering=0) as file:
            words = file.read(MAX_COMMAND_LINE).rstrip(b"\0")
    except OSError:
        return []
    return [word.decode("utf-8", "replace") for word in words.split(b"\0")] if words else []


def _own_id(pid: int) -> int:
    """The id by which a process knows itself, which is another one in a PID namespace; 0 where it is gone."""
    return int((_status(pid, "NSpid") or ["0"])[-1])


def _parent_of(pid: int) -> int:
    """The process that started this one, or has adopted it; 0 where it is gone."""
    return int((_status(pid, "PPid") or ["0"])[0])


def _status(pid: int, name: str) -> list[str]:
    """The words of a line of proc(5)'s status; none where there is no such line."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return []
    return next((line.split()[1:] for line in lines if line.startswith(f"{name}:")), [])


def tell(line: str) -> None:
    """Print a line in one piece: what else writes to the same pipe cannot come between it and its end."""
    os.write(1, f"{line}\n".encode("utf-8", "replace"))


@contextlib.contextmanager
def watched(pid: int, report: Callable[[str], None]) -> Iterator[None]:
    """Look at the processes below one, in a thread.

    Args:
        pid: That one.
        report: Told each process and command line once, in the line of the report that a check reads.
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
    known: set[tuple[int, tuple[str, ...]]] = set()
    while not ended.wait(LOOK_EVERY):
        for child in descendants(pid):
            argv = tuple(_arguments_of(child))
            if argv and (child, argv) not in known and len(known) < MAX_COMMAND_LINES:
                known.add((child, argv))
                report(process_line(Process(_own_id(child), _own_id(_parent_of(child)), argv)))
