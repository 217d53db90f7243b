"""Run a launch, and report how it started its processes.

A topic that is renamed in the code and one that is remapped by the launch file look the same on the wire. What tells
them apart is the command line of the process: that is how every launch hands a remapping to a node.
"""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.kit.launch_report import Process, process_line
from autograder.workspaces.building.colcon import build
from autograder.workspaces.running.plans import lacks_programs, launch_targets, reference_workspace
from autograder.workspaces.running.prefixes import with_prefixes
from autograder.workspaces.running.processes import arguments_of, descendants, own_id, parent_of, tell
from autograder.workspaces.running.reporting import built_line
from autograder.workspaces.sources.finding import workspace_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

LOOK_EVERY = 0.05
"""Seconds between two looks at the launch's processes."""


def launch(command: Sequence[str], file: Path | None) -> int:
    """Run a launch command with the student's packages and, after these, the course's own ``my_robot_pkg``.

    Args:
        command: Such as ``["ros2", "launch", "remap.launch.py"]``.
        file: The launch file, where that is all that was given: what it needs of its workspace is built.

    Returns:
        The launch's exit code; 1 when the student's packages could not be built.
    """
    environment: dict[str, str] = dict(os.environ)
    own = reference_workspace()
    # What students are handed has no programs but theirs: those would be Lab 1.2's solutions.
    course_build = build(own) if own.is_dir() else None
    workspace = workspace_of(file, (file.resolve().parent, Path.cwd())) if file is not None else None
    first = False
    if file is not None and workspace is not None:
        made = build(workspace, launch_targets(file))
        tell(built_line(made))
        if not made.ok:
            return 1
        environment = with_prefixes(environment, made.prefixes)
        first = course_build is not None and lacks_programs(file, made, course_build)
    if course_build is not None:
        environment = with_prefixes(environment, course_build.prefixes, last=not first)
    return _run(command, environment)


def _run(command: Sequence[str], environment: dict[str, str]) -> int:
    # Ctrl-C reaches the whole process group: the launch ends its nodes and then itself, and this waits for it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    process = subprocess.Popen(command, env=environment, preexec_fn=_listen_to_interrupts)
    signal.signal(signal.SIGTERM, lambda *_: process.terminate())
    ended = threading.Event()
    watcher = threading.Thread(target=_watch, args=(process.pid, ended), daemon=True)
    watcher.start()
    try:
        return process.wait()
    finally:
        ended.set()
        watcher.join()


def _listen_to_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _watch(pid: int, ended: threading.Event) -> None:
    """Report the command line of each process below the launch once."""
    watch_processes(pid, ended, lambda process: tell(process_line(process)))


def watch_processes(pid: int, ended: threading.Event, on_process: Callable[[Process], None]) -> None:
    """Look at the processes below one until it has ended.

    Args:
        pid: That one.
        ended: Set when there is nothing to look at any more.
        on_process: Called once for each process and command line.
    """
    known: set[tuple[int, tuple[str, ...]]] = set()
    while not ended.wait(LOOK_EVERY):
        for child in descendants(pid):
            argv = tuple(arguments_of(child))
            if argv and (child, argv) not in known:
                known.add((child, argv))
                on_process(Process(own_id(child), own_id(parent_of(child)), argv))
