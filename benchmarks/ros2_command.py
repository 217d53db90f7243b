"""``python -m benchmarks.ros2_command``: the course's ``ros2`` in a session with many notebooks open.

Executes the notebooks of the course, solutions included, each in a kernel on the one domain that ``./course lab`` gives
its session, leaves all kernels alive, and calls three commands again and again. A miss is a call that fails, warns, or
leaves out something that a long look finds. Seconds tell of the machine and of what else it does; misses must not.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import shutil
import statistics
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from jupyter_client.manager import KernelManager
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_notebook

from autograder import check_journal, course
from autograder.masters.master_files import chapter_path, lab_name, masters
from autograder.masters.source_notebooks import source_notebook
from autograder.safe_files import HeldFolder
from autograder.student.lab import join_domain
from course_runtime.python_child import installed_program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from nbformat import NotebookNode

AT_ONCE = 4
"""Notebooks that are executed at a time: most of their cells wait for something."""
CELL_LIMIT = 600.0
"""Seconds that a cell may take: it may build a workspace while others do."""
LONG_LOOK = "5"
"""Seconds of the look that every other one is compared with."""
ROS2 = installed_program("ros2")
TOPIC, NODE = "/counted_ticks", "/tick_counter"
TALKER = f"""
from rclpy.node import Node
from std_msgs.msg import String
from autograder.notebook import spin_in_background, start_ros

start_ros()
node = Node("{NODE[1:]}")
publisher = node.create_publisher(String, "{TOPIC[1:]}", 10)
node.create_timer(0.1, lambda: publisher.publish(String(data="tick")))
spin_in_background(node)
"""


@dataclass(frozen=True)
class Figure:
    """The result of one command.

    Attributes:
        command: Its words.
        seconds: What each call took.
        misses: What was wrong with each call that was not right.
    """

    command: str
    seconds: tuple[float, ...]
    misses: tuple[str, ...]

    def row(self) -> str:
        """A row of the printed table, in Markdown."""
        median, longest = statistics.median(self.seconds), max(self.seconds)
        return f"| `{self.command}` | {len(self.seconds)} | {len(self.misses)} | {median:.2f} s | {longest:.2f} s |"


class Open(NamedTuple):
    """A notebook to be opened: its name, its content, and the folder that its cells run in."""

    name: str
    notebook: NotebookNode
    folder: Path


@contextlib.contextmanager
def open_notebooks(notebooks: Sequence[Open], folder: Path) -> Iterator[None]:
    """Execute notebooks in one session, and leave their kernels alive within the ``with`` block.

    Args:
        notebooks: What is opened.
        folder: The folder for the journal of their checks.
    """
    before = dict(os.environ)
    claim = join_domain()
    os.environ[check_journal.VARIABLE] = str(folder / check_journal.NAME)
    managers: list[KernelManager] = []

    def execute(name: str, notebook: NotebookNode, folder: Path) -> None:
        manager = KernelManager(kernel_name="python3")
        managers.append(manager)
        manager.start_kernel(cwd=str(folder))
        began = time.monotonic()
        NotebookClient(notebook, km=manager, timeout=CELL_LIMIT, allow_errors=True).execute()
        print(f"executed {name} in {time.monotonic() - began:.0f} s", file=sys.stderr)

    try:
        with ThreadPoolExecutor(AT_ONCE) as pool:
            for done in [pool.submit(execute, *notebook) for notebook in notebooks]:
                done.result()
        yield
    finally:
        for manager in managers:
            manager.shutdown_kernel(now=True)
        if claim:
            claim.release()
        os.environ.clear()
        os.environ.update(before)


def call(*words: str) -> tuple[float, subprocess.CompletedProcess[str]]:
    """Call ``ros2``: the seconds that it took, and what came of it."""
    began = time.monotonic()
    done = subprocess.run([ROS2, *words], capture_output=True, text=True, check=False)
    return time.monotonic() - began, done


def missed(done: subprocess.CompletedProcess[str], expected: set[str]) -> str:
    """Return what is wrong with a call; empty if nothing is."""
    missing = expected - set(done.stdout.splitlines())
    if done.returncode or done.stderr or missing:
        return f"exit code {done.returncode}, {done.stderr.strip()!r}, missing: {sorted(missing)}"
    return ""


def measure_commands(times: int, told: Callable[[str], None] = print) -> list[Figure]:
    """Call each command so many times; the notebooks are open, one of them with TALKER.

    Args:
        times: How often.
        told: Is told each miss when it comes.
    """
    long = ("--spin-time", LONG_LOOK)
    commands: dict[tuple[str, ...], set[str]] = {
        ("topic", "echo", "--once", TOPIC): {"data: tick"},
        ("topic", "list"): set(call("topic", "list", *long)[1].stdout.splitlines()),
        ("node", "info", NODE): set(call("node", "info", NODE, *long)[1].stdout.splitlines()),
    }
    seconds: dict[tuple[str, ...], list[float]] = {words: [] for words in commands}
    misses: dict[tuple[str, ...], list[str]] = {words: [] for words in commands}
    for _ in range(times):
        for words, expected in commands.items():
            took, done = call(*words)
            seconds[words].append(took)
            if wrong := missed(done, expected):
                misses[words].append(wrong)
                told(f"ros2 {' '.join(words)}: {wrong}")
    return [
        Figure(f"ros2 {' '.join(words)}", tuple(seconds[words]), tuple(misses[words])) for words in commands
    ]


def measure(times: int, only: Sequence[str] = ()) -> tuple[int, list[Figure]]:
    """Open the notebooks and measure; how many kernels were alive, and the figures.

    Args:
        times: How often each command is called.
        only: Names such as ``"lab_1_2"``; all notebooks of the course where empty.
    """
    root = course.root()
    with HeldFolder("autograder-bench-") as place:
        copy = Path(shutil.copytree(root / "chapters", place.path / "chapters"))
        notebooks = [
            Open(lab_name(master), source_notebook(master), copy / chapter_path(root, master).parent.name)
            for master in masters(root)
            if not only or lab_name(master) in only
        ]
        notebooks.append(Open("a talker", new_notebook(cells=[new_code_cell(TALKER)]), copy))
        with open_notebooks(notebooks, copy):
            return len(notebooks), measure_commands(times)


def main() -> int:
    """Measure and print the table; return 1 if a call missed something."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ros2_command")
    parser.add_argument("--times", type=int, default=100, help="how often each command is called")
    parser.add_argument("only", nargs="*", help="names of notebooks; all without")
    options = parser.parse_args()
    kernels, figures = measure(options.times, options.only)
    print(f"{kernels} kernels alive.")
    print("| command | calls | misses | median | longest |", "| --- | --- | --- | --- | --- |", sep="\n")
    for figure in figures:
        print(figure.row())
    return int(any(figure.misses for figure in figures))


if __name__ == "__main__":
    sys.exit(main())
