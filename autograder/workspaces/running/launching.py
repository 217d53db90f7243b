"""Run a launch, and report how it started its processes.

A topic that is renamed in the code and one that is remapped by the launch file look the same on the wire. What tells
them apart is the command line of the process: that is how every launch hands a remapping to a node.
"""

from __future__ import annotations

import contextlib
import signal
import subprocess
import threading
from typing import TYPE_CHECKING

from autograder.kit.launch_report import Process, process_line
from autograder.workspaces.running.processes import arguments_of, descendants, own_id, parent_of, tell

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

LOOK_EVERY = 0.05
"""Seconds between two looks at the launch's processes."""


def run_launch(command: Sequence[str], environment: Mapping[str, str]) -> int:
    """Run a launch to its end; its exit code.

    Args:
        command: Such as ``["ros2", "launch", "remap.launch.py"]``.
        environment: Its whole environment.
    """
    # Ctrl-C reaches the whole process group: the launch ends its nodes and then itself, and this waits for it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    process = subprocess.Popen(command, env=environment, preexec_fn=_listen_to_interrupts)
    signal.signal(signal.SIGTERM, lambda *_: process.terminate())
    with watched(process.pid, lambda child: tell(process_line(child))):
        return process.wait()


def _listen_to_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@contextlib.contextmanager
def watched(pid: int, on_process: Callable[[Process], None]) -> Iterator[None]:
    """Look at the processes below one in a thread.

    Args:
        pid: That one.
        on_process: Called once for each process and command line.
    """
    ended = threading.Event()
    watcher = threading.Thread(target=_watch, args=(pid, ended, on_process), daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()


def _watch(pid: int, ended: threading.Event, on_process: Callable[[Process], None]) -> None:
    known: set[tuple[int, tuple[str, ...]]] = set()
    while not ended.wait(LOOK_EVERY):
        for child in descendants(pid):
            argv = tuple(arguments_of(child))
            if argv and (child, argv) not in known:
                known.add((child, argv))
                on_process(Process(own_id(child), own_id(parent_of(child)), argv))
