"""``python -m benchmarks.cpu_by_role``: the CPU seconds of grading a class, by what spends them.

.. code-block:: console

    $ git worktree add ../before fca1f087
    $ python -m benchmarks.cpu_by_role --against ../before exercise_1_2 lab_1_3

Both versions of the course grade the same answers, by turns, so that whatever else the machine does meets both. A CPU
second of a busy core does less than one of an idle core: compare only what one run has printed. On a busy machine, put
``nice -n -20`` before it. ``colcon`` calls ``ninja`` with ``-l``: one compiler runs at a time while the load is above
the number of processors.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import shutil
import statistics
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Self

import msgspec

from autograder import course
from autograder.safe_files import fresh_folder
from benchmarks.machine import CpuGroup

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_EVERY_SECONDS = 0.03
_FORK_SERVER = "boxes.fork_server"
_SERVED = {
    "kernel_process": "kernels",
    "program_process": "programs",
    "supervisor": "boxes",
    ".judge.": "judges",
    "desk_program": "desks",
}
"""For a part of the name of a fork server's module: the role of its children."""
_MAKE_CLASS = """
import sys
from pathlib import Path
from benchmarks.classes import make_class
make_class(Path(sys.argv[1]), int(sys.argv[2]), tuple(sys.argv[3:]))
"""
ROLES = {
    "grader": "`autograder grade` itself",
    "executor": "the process that executes notebooks",
    "fork servers": "their start, and forking",
    "boxes": "supervisors and bubblewrap",
    "kernels": "kernels, with what students' nodes do in them",
    "commands": "what cells start: shells, `ros2`, `colcon`",
    "desks": "the parsers of notebooks and of kernels' messages",
    "judges": "",
    "builds": "colcon, in boxes of its own",
    "programs": "workspaces' programs and launch files",
}
"""The roles, and what each of them includes."""


def role_of(words: str, folder: str, now: str) -> str:
    """Return the role of a process.

    Args:
        words: Its command line. That of a fork is the fork server's.
        folder: Its current folder.
        now: Its role until now, which is that of the process that started it.
    """
    if not words:  # the process is ending
        return now
    if _FORK_SERVER in words:
        served = words.partition(_FORK_SERVER)[2]
        role = next((role for part, role in _SERVED.items() if part in served), now)
        # A kernel works in the folder of its notebook, and its desk, a fork of the same server, in no folder.
        return "desks" if role == "kernels" and folder == "/" else role
    if ".order_executor" in words or ".running.worker" in words:
        return "executor"
    if now == "boxes" and "/bin/cat" not in words:
        return "builds" if "colcon" in words or "build_artifacts" in words else "programs"
    return "commands" if now in ("kernels", "desks") else now


@dataclass
class Accounts:
    """Counts the CPU seconds of a process and of all that it starts, by role, while its ``with`` block runs.

    Each role has a control group. A process begins in the group of the process that started it, and is put into that
    of its own role within some hundredths of a second.
    """

    seconds: dict[str, float] = field(default_factory=dict)

    def __enter__(self) -> Self:
        groups = {role: CpuGroup.make() for role in ROLES if role != "fork servers"}
        self._groups = {role: group for role, group in groups.items() if group}
        if len(self._groups) < len(groups):
            raise OSError("this system makes no control groups that count CPU time")
        self._servers: dict[int, tuple[str, float]] = {}
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self.seconds = {role: group.seconds() for role, group in self._groups.items()}
        for role, spent in self._servers.values():
            self.seconds[role] -= spent
        self.seconds["fork servers"] = sum(spent for _, spent in self._servers.values())
        for group in self._groups.values():
            group.remove()

    def prepare(self) -> None:
        """Count this process from here on; called in the child, before it becomes the program."""
        self._groups["grader"].join()

    def _watch(self) -> None:
        while not self._stop.wait(_EVERY_SECONDS):
            for role, group in self._groups.items():
                for pid in map(int, (group.folder / "cgroup.procs").read_text().split()):
                    with contextlib.suppress(OSError):  # the process has ended
                        self._place(pid, role)

    def _place(self, pid: int, now: str) -> None:
        process = Path(f"/proc/{pid}")
        words = _words(process)
        parent, spent = _parent_and_spent(process)
        is_server = _FORK_SERVER in words and _FORK_SERVER not in _words(Path(f"/proc/{parent}"))
        role = role_of(words, "" if is_server else str((process / "cwd").readlink()), now)
        if is_server:
            self._servers[pid] = (role, spent)
        if role != now:
            self._groups[role].take(pid)


def _words(process: Path) -> str:
    return (process / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")


def _parent_and_spent(process: Path) -> tuple[int, float]:
    """The parent of a process, and the CPU seconds of the process alone (proc_pid_stat(5))."""
    fields = (process / "stat").read_text().rpartition(")")[2].split()
    return int(fields[1]), (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True)
class _Side:
    """A checkout of the course, and the class that it grades.

    Its programs start with a plain environment: this process has the libraries of its own checkout in its.
    """

    checkout: Path
    made: Path

    def make(self, students: int, assignments: Sequence[str]) -> None:
        subprocess.run([str(self.checkout / "course"), "setup"], env=_plain(), stdout=sys.stderr, check=True)
        python = str(self.checkout / ".venv/bin/python")
        words = [python, "-c", _MAKE_CLASS, str(self.made), str(students), *assignments]
        subprocess.run(words, cwd=self.checkout, env=_plain(), check=True)

    def spent(self, options: Sequence[str]) -> dict[str, float]:
        """CPU seconds a notebook of grading a copy of the class, by role."""
        copy = self.made.with_name("graded")
        shutil.copytree(self.made, copy)
        try:
            with Accounts() as accounts:
                done = subprocess.run(
                    [str(self.checkout / "course"), "grade", str(copy), "--json", *options],
                    cwd=self.checkout,
                    env=_plain(),
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    preexec_fn=accounts.prepare,
                    check=False,
                )
        finally:
            shutil.rmtree(copy)
        notebooks = int(msgspec.json.decode(done.stdout)["totals"]["executed"])
        return {role: seconds / notebooks for role, seconds in accounts.seconds.items()}


def _tell(words: str) -> None:
    print(words, file=sys.stderr, flush=True)


def _plain() -> dict[str, str]:
    return {name: os.environ[name] for name in ("HOME", "LANG", "PATH") if name in os.environ}


def table(before: Sequence[Mapping[str, float]], now: Sequence[Mapping[str, float]]) -> str:
    """The median CPU seconds a notebook of each role, as a table in Markdown.

    Args:
        before: Of each run of the other version; empty if there is none.
        now: Of each run of this version.
    """
    lines = ["| CPU seconds a notebook | other | this | this/other |", "| --- | ---: | ---: | ---: |"]
    for role, what in {**ROLES, "all": "median of the runs"}.items():
        old, new = (
            [sum(run.values()) if role == "all" else run[role] for run in runs] for runs in (before, now)
        )
        other = statistics.median(old) if old else 0.0
        this = statistics.median(new)
        ratio = f"{this / other:.2f}" if other else "–"
        lines.append(f"| {role}{f': {what}' if what else ''} | {other:.3f} | {this:.3f} | {ratio} |")
    return "\n".join(lines)


def main() -> None:
    """Grade by turns, and print the table of all rounds so far after each round."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.cpu_by_role", description=__doc__)
    options.add_argument("labs", nargs="+", metavar="LAB", help="the assignments, such as lab_1_2")
    options.add_argument("--against", type=Path, help="another checkout of the course that is set up")
    options.add_argument("--students", type=int, default=2)
    options.add_argument("--rounds", type=int, default=2)
    options.add_argument("--jobs", default="2", help="notebooks at the same time")
    chosen = options.parse_args()
    folder = fresh_folder("benchmark-")
    checkouts = [path.resolve() for path in (chosen.against, course.root()) if path]
    sides = [_Side(checkout, folder / str(number) / "class") for number, checkout in enumerate(checkouts)]
    runs: dict[_Side, list[dict[str, float]]] = {side: [] for side in sides}
    try:
        for side in sides:
            side.make(chosen.students, chosen.labs)
            # The same answers for both: the banks of two versions differ.
            if side is not sides[-1]:
                shutil.rmtree(side.made / "submitted")
        for side in sides[:-1]:
            shutil.copytree(sides[-1].made / "submitted", side.made / "submitted")
        for side in sides:
            _tell(f"{side.checkout}: building what is built once for all classes, which may take minutes")
            side.spent(("--student", "student-000"))
        for turn in range(chosen.rounds):
            for side in sides if turn % 2 else sides[::-1]:
                runs[side].append(side.spent(("--jobs", chosen.jobs)))
                _tell(f"{side.checkout}: {sum(runs[side][-1].values()):.2f} s a notebook")
            # After each round, so that a run that is ended early has shown something.
            print(table(runs[sides[0]] if len(sides) > 1 else [], runs[sides[-1]]), flush=True)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
