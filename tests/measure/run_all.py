"""*Restart and Run All* in one student's folder, again and again, in real kernels.

The solved notebooks are run in the order of the chapter, three times, and in two mixed orders, each notebook in a
kernel of its own. After each pass the sources of the workspace must be those of the first, byte for byte, nothing else
may lie beside the notebooks, and every check must have earned all of its points. A pass takes 90 to 160 seconds of a
processor.
"""

from __future__ import annotations

import os
import resource
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError

from autograder import check_journal, course
from autograder.authoring.executed_masters import execute_in_new_kernel
from autograder.dds_discovery import DOMAIN_VARIABLE, claim_free_domain
from autograder.masters.master_files import lab_name, masters
from autograder.masters.source_notebooks import source_notebook

if TYPE_CHECKING:
    import argparse
    from collections.abc import Mapping, Sequence

    from nbformat import NotebookNode

SOURCES = "ros2_ws/src"
"""Where the student's packages are, beside the notebooks."""


@dataclass(frozen=True)
class Left:
    """What lies in a student's folder after a pass.

    Attributes:
        sources: The text of each file of the workspace's sources, by its path.
        beside: The names of what lies beside the notebooks.
    """

    sources: Mapping[str, bytes]
    beside: frozenset[str]


@dataclass(frozen=True)
class Pass:
    """One pass through notebooks.

    Attributes:
        order: Their names, as they were run.
        left: What lay there in the end.
        wrong: What was wrong, in words: errors of cells, and checks without all of their points.
        seconds: Wall time.
        cpu: Seconds that the kernels, with all that they started, were on a processor.
    """

    order: Sequence[str]
    left: Left
    wrong: list[str] = field(default_factory=list)
    seconds: float = 0.0
    cpu: float = 0.0


def left_in(folder: Path) -> Left:
    """What lies in a student's folder now; no compiled Python."""
    sources = folder / SOURCES
    files = (path for path in sorted(sources.rglob("*")) if path.is_file() and path.suffix != ".pyc")
    return Left(
        {str(path.relative_to(sources)): path.read_bytes() for path in files},
        frozenset(path.name for path in folder.iterdir()),
    )


def run_all(folder: Path, notebooks: Mapping[str, NotebookNode], order: Sequence[str]) -> Pass:
    """Run notebooks one after the other, each from its first cell in a new kernel.

    Args:
        folder: The student's.
        notebooks: By name.
        order: The names, in the order in which they are run.
    """
    wrong: list[str] = []
    began, cpu = time.monotonic(), _cpu_of_children()
    with tempfile.TemporaryDirectory(prefix="journal-") as kept:
        lines = Path(kept, "journal.jsonl")
        for name in order:
            if trouble := _run(notebooks[name], folder, lines):
                wrong.append(f"{name}: {trouble}")
        checks = [entry for entry in check_journal.entries(lines) if entry.kind == "check"]
    wrong += [f"{one.name}: {one.points:g} of {one.possible:g} points" for one in checks if not one.full]
    asked = sum(
        "check(" in cell.source for name in order for cell in notebooks[name].cells if _is_check(cell)
    )
    if len(checks) != asked:
        wrong.append(f"{len(checks)} checks were made, and {asked} are asked for")
    seconds = time.monotonic() - began
    return Pass(order, left_in(folder), wrong, seconds, _cpu_of_children() - cpu)


def _run(notebook: NotebookNode, folder: Path, lines: Path) -> str:
    """Run one notebook in a new kernel; what went wrong, or nothing."""
    try:
        execute_in_new_kernel(NotebookClient(notebook), folder, lines)
    except (CellExecutionError, CellTimeoutError, DeadKernelError) as error:
        return str(error)
    return ""


def _is_check(cell: NotebookNode) -> bool:
    about = cell.metadata.get("nbgrader", {})
    return bool(about.get("grade")) and not about.get("solution")


def differences(first: Left, now: Left) -> list[str]:
    """What is not as after the first pass, in words."""
    found = [
        f"{path}: {'is new' if path not in first.sources else 'is gone' if path not in now.sources else 'differs'}"
        for path in sorted(first.sources.keys() | now.sources.keys())
        if first.sources.get(path) != now.sources.get(path)
    ]
    return found + [
        f"{name}: lies there in one of the passes only" for name in sorted(first.beside ^ now.beside)
    ]


def orders(names: Sequence[str], seed: int) -> list[Sequence[str]]:
    """Three times the order of the chapter, then two mixed ones."""
    random = Random(seed)
    return [names, names, names, *(random.sample(list(names), len(names)) for _ in range(2))]


def again_and_again(
    notebooks: Mapping[str, NotebookNode], passes: Sequence[Sequence[str]], folder: Path
) -> list[str]:
    """Run the passes in a folder, say how each went, and return all that was wrong.

    Args:
        notebooks: By name.
        passes: The names for each pass, in the order in which they are run.
        folder: An empty one, which becomes the student's.
    """
    wrong: list[str] = []
    first: Left | None = None
    with_claim = claim_free_domain()
    os.environ[DOMAIN_VARIABLE] = str(with_claim.domain)
    try:
        for number, order in enumerate(passes, start=1):
            done = run_all(folder, notebooks, order)
            first = first or done.left
            found = [*done.wrong, *differences(first, done.left)]
            print(
                f"pass {number} ({' '.join(order)}): {len(done.left.sources)} source files, {len(found)} wrong, "
                f"{done.seconds:.0f} s, {done.cpu:.0f} CPU s",
                flush=True,
            )
            for text in found:
                print(f"  {text}", flush=True)
            wrong += [f"pass {number}: {text}" for text in found]
    finally:
        with_claim.release()
    return wrong


def _cpu_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    parser.add_argument("only", nargs="*", help="names of notebooks, such as lab_1_1; all by default")
    parser.add_argument("--seed", type=int, default=0, help="what the mixed orders are drawn from")


def main(options: argparse.Namespace) -> int:
    """Run; 1 where something was wrong, 2 where a name is unknown."""
    notebooks = {lab_name(master): source_notebook(master) for master in masters(course.root())}
    if unknown := [name for name in options.only if name not in notebooks]:
        print(f"there is no notebook {unknown[0]!r}. There are: {', '.join(notebooks)}.", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory(prefix="student-") as folder:
        passes = orders(options.only or list(notebooks), options.seed)
        return 1 if again_and_again(notebooks, passes, Path(folder)) else 0
