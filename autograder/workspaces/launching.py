"""Run a launch, and report how it started its processes.

A topic that is renamed in the code and one that is remapped by the launch file look the same on the wire. What tells
them apart is the command line of the process: that is how every launch hands a remapping to a node.
"""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import threading
from collections.abc import Callable, Sequence
from pathlib import Path

from autograder import course
from autograder.exercises.launch_report import process_line
from autograder.workspaces.building import Build, build
from autograder.workspaces.prefixes import with_prefixes
from autograder.workspaces.processes import command_line, descendants, tell

LOOK_EVERY = 0.05
"""Seconds between two looks at the launch's processes."""
WORKSPACE = "ros2_ws"

Report = Callable[[Build, str], None]


def launch(command: Sequence[str], file: Path | None, report: Report) -> int:
    """Run a launch command with the student's packages and, after these, the course's own ``my_robot_pkg``.

    Args:
        command: Such as ``["ros2", "launch", "remap.launch.py"]``.
        file: The launch file, where that is all that was given: its workspace is built.
        report: Called with the student's workspace, where there is one, after it was built.

    Returns:
        The launch's exit code; 1 when the student's workspace could not be built.
    """
    environment: dict[str, str] = dict(os.environ)
    course_build = build(reference_workspace())
    workspace = workspace_of(file) if file is not None else None
    first = False
    if file is not None and workspace is not None:
        made = build(workspace)
        report(made, "built")
        if not made.ok:
            return 1
        environment = with_prefixes(environment, made.prefixes)
        first = _lacks_programs(file, made, course_build)
    return _run(command, with_prefixes(environment, course_build.prefixes, last=not first))


def _lacks_programs(file: Path, made: Build, course_build: Build) -> bool:
    """Whether a launch file names programs of the course's package that the student's has not got.

    Who has written talker and listener in the notebooks alone has no programs to launch.
    """
    words = set(re.findall(r"\w+", file.read_text(encoding="utf-8", errors="replace")))
    return bool(words & _programs(course_build) - _programs(made))


def _programs(made: Build) -> set[str]:
    return {program.name for prefix in made.prefixes for program in (prefix / "lib" / prefix.name).glob("*")}


def workspace_of(file: Path) -> Path | None:
    """The workspace that a launch file lies in, or the one beside it or in the current folder."""
    around = [folder for folder in file.resolve().parents if (folder / "src").is_dir()]
    beside = [folder / WORKSPACE for folder in (file.resolve().parent, Path.cwd())]
    found = [folder for folder in (*around[:1], *beside) if any((folder / "src").glob("**/package.xml"))]
    return found[0] if found else None


def reference_workspace() -> Path:
    """The workspace with the course's own talker and listener."""
    return course.root() / "solutions" / WORKSPACE


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
    known: set[tuple[int, str]] = set()
    while not ended.wait(LOOK_EVERY):
        for child in descendants(pid):
            line = command_line(child)
            if line and (child, line) not in known:
                known.add((child, line))
                tell(process_line(shlex.split(line)))
