"""``python -m benchmarks.cluster``: what a notebook costs on a cluster, and what follows for large classes.

A scheduler, one worker and the grader run on this machine, each in a control group of its own that counts its CPU time.
Two classes of different size are graded; the difference is what their difference in notebooks costs, without what is
spent once. The figures are kept in ``benchmarks/cluster.json`` and put into ``docs/performance.md``.
"""

from __future__ import annotations

import datetime
import os
import shutil
import subprocess
import sys
import threading
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder import course
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.tasks.task_making import task_of
from autograder.safe_files import fresh_folder
from benchmarks.classes import make_class
from benchmarks.machine import Machine, Watch, machine
from benchmarks.ours import AUTOGRADER
from benchmarks.results import replace_between
from course_runtime.python_child import installed_program

if TYPE_CHECKING:
    from collections.abc import Iterator

KEPT = Path(__file__).with_name("cluster.json")
PAGE = course.root() / "docs" / "performance.md"
BEGIN, END = "<!-- costs: written by benchmarks.cluster -->", "<!-- end of costs -->"
STUDENTS = (1, 4)
SUBMISSIONS = (100, 1_000, 100_000)
CORES = (2, 16, 128, 1_024)
BUSY = 0.85
"""The share of its cores that a worker keeps busy: what benchmarks/ demands of one machine."""


@dataclass(frozen=True)
class Costs:
    """The costs of one notebook, on average over the chapter's graded ones.

    Attributes:
        machine: What was measured on.
        when: The day.
        load: The load average meanwhile, at its end.
        notebooks: How many the difference of the two classes is.
        worker: CPU seconds on a worker: box, kernel, student's code, judge.
        grader: CPU seconds in the grader and its courier: rebuilding, sending, gradebook, page.
        scheduler: CPU seconds in Dask's scheduler.
        sent: Bytes to the worker.
        received: Bytes back.
    """

    machine: Machine
    when: str
    load: float
    notebooks: int
    worker: float
    grader: float
    scheduler: float
    sent: float
    received: float


@dataclass(frozen=True)
class _Spent:
    notebooks: int
    worker: float
    grader: float
    scheduler: float


def seconds(costs: Costs, submissions: int, cores: int) -> float:
    """How long a class takes: the workers' work over their cores, or that of the slowest single process."""
    return submissions * max(costs.worker / (BUSY * cores), _alone(costs))


def _alone(costs: Costs) -> float:
    """CPU seconds a notebook of what there is one of: the grader or the scheduler, whichever takes longer."""
    return max(costs.grader, costs.scheduler)


def markdown(costs: Costs) -> str:
    """The costs and what follows, as a piece of Markdown."""
    on = costs.machine
    lines = [
        f"Measured on {costs.when} on {on.cores} cores ({on.system}, CPython {on.python}), at a load average of "
        f"{costs.load:.1f}, as the mean over {costs.notebooks} notebooks of chapter 1:",
        "",
        "| one notebook costs | |",
        "| --- | --- |",
        f"| on a worker: box, kernel, student's code, judge | {costs.worker:.2f} CPU seconds |",
        f"| in the grader: rebuilding, sending, gradebook, feedback page | {costs.grader:.3f} CPU seconds |",
        f"| in Dask's scheduler | {costs.scheduler:.3f} CPU seconds |",
        f"| on the network | {costs.sent / 1e3:.0f} kB to the worker, {costs.received / 1e3:.0f} kB back |",
        "",
        "So, with *S* submissions of one notebook and *P* cores on workers, a class takes",
        "",
        f"    S × max( {costs.worker:.2f} s / ({BUSY:g} × P),  {costs.grader:.3f} s,  {costs.scheduler:.3f} s )",
        "",
        "| submissions | CPU time on workers | " + " | ".join(f"{cores:,} cores" for cores in CORES) + " |",
        "| ---: | ---: |" + " ---: |" * len(CORES),
    ]
    lines += [
        f"| {submissions:,} | {_told(submissions * costs.worker)} | "
        + " | ".join(_told(seconds(costs, submissions, cores)) for cores in CORES)
        + " |"
        for submissions in SUBMISSIONS
    ]
    most = costs.worker / (BUSY * _alone(costs))
    lines += [
        "",
        "The terms are the workers', the grader's and the scheduler's. The last two are one process each, so beyond "
        f"about {_rounded(most)} cores more of them do not help. Add a few seconds for starting, and for what runs "
        "longest. Workers need enough notebooks at once (`--jobs`) to keep their cores busy.",
    ]
    return "\n".join(lines) + "\n"


def put_into(page: Path, costs: Costs) -> None:
    """Replace the costs that a page quotes.

    Raises:
        ValueError: The page has no place for them.
    """
    replace_between(page, BEGIN, END, markdown(costs))


def measure(folder: Path) -> Costs:
    """Measure in a folder."""
    spent = []
    sent = received = 0.0
    for students in STUDENTS:
        print(f"a class of {students} students … ", end="", file=sys.stderr, flush=True)
        made = make_class(folder / f"class-{students}", students)
        spent.append(_grade(made.path, folder))
        print(f"{spent[-1]}", file=sys.stderr, flush=True)
        sent, received = _bytes(made.path)
    small, large = spent
    notebooks = large.notebooks - small.notebooks
    return Costs(
        machine=machine(),
        when=datetime.datetime.now(tz=datetime.UTC).date().isoformat(),
        load=round(os.getloadavg()[0], 1),
        notebooks=notebooks,
        worker=(large.worker - small.worker) / notebooks,
        grader=(large.grader - small.grader) / notebooks,
        scheduler=(large.scheduler - small.scheduler) / notebooks,
        sent=sent,
        received=received,
    )


def _grade(path: Path, folder: Path) -> _Spent:
    address = f"tcp://127.0.0.1:{_free_port()}"
    dask = [
        "dask",
        "scheduler",
        "--no-dashboard",
        "--host",
        "127.0.0.1",
        "--port",
        address.rpartition(":")[2],
    ]
    with (
        _running([str(installed_program(dask[0])), *dask[1:]], folder, "Scheduler at") as scheduler,
        _running([*AUTOGRADER, "worker", address], folder, "waits for work") as worker,
        Watch() as grader,
    ):
        done = subprocess.run(
            [*AUTOGRADER, "grade", str(path), "--json", "--scheduler", address],
            stdout=subprocess.PIPE,
            preexec_fn=grader.prepare,
            check=False,
        )
    if done.returncode not in (0, 2) or not done.stdout:
        raise RuntimeError(f"autograder grade ended with {done.returncode}")
    counted = [watch.usage.own_cpu if watch.usage else None for watch in (worker, grader, scheduler)]
    if None in counted:
        raise RuntimeError("this system does not count the CPU time of a group of processes")
    executed = int(msgspec.json.decode(done.stdout)["totals"]["executed"])
    return _Spent(executed, *(float(cpu or 0.0) for cpu in counted))


@contextmanager
def _running(command: list[str], folder: Path, ready: str) -> Iterator[Watch]:
    """A process that was waited for until it said that it is ready."""
    with Watch() as watch:
        process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=folder,
            preexec_fn=watch.prepare,
        )
        assert process.stdout
        try:
            if not any(ready in line for line in process.stdout):
                raise RuntimeError(f"{command} did not start")
            # A pipe that is not read would fill up with the log, and stop the process.
            threading.Thread(target=process.stdout.read, daemon=True).start()
            yield watch
        finally:
            process.terminate()
            process.wait(timeout=30)


def _bytes(path: Path) -> tuple[float, float]:
    """Mean bytes of the tasks of a class, and of their results as the store has them."""
    directory = ClassDirectory(path)
    tasks = [
        len(msgspec.json.encode(task_of(directory, found, notebook)[0]))
        for found in directory.submissions()[0]
        for notebook in directory.notebooks(found.assignment)
    ]
    with ClassStore(directory) as store:
        results = [
            len(msgspec.json.encode(result))
            for found in directory.submissions()[0]
            for result in store.results(found.student, found.assignment).values()
        ]
    return sum(tasks) / len(tasks), sum(results) / max(1, len(results))


def _free_port() -> int:
    import socket

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


def _told(spent: float) -> str:
    for size, unit in ((86_400, "d"), (3_600, "h"), (60, "min")):
        if spent >= 2 * size:
            return f"{spent / size:.1f} {unit}" if spent < 10 * size else f"{spent / size:.0f} {unit}"
    return f"{spent:.0f} s"


def _rounded(cores: float) -> str:
    digits = max(0, len(f"{cores:.0f}") - 1)
    return f"{round(cores, -digits):.0f}"


def main() -> int:
    """Measure, print, keep, and put into the page."""
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    folder = fresh_folder("cluster-")
    try:
        costs = measure(folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    KEPT.write_bytes(msgspec.json.format(msgspec.json.encode(costs), indent=2) + b"\n")
    put_into(PAGE, costs)
    print(markdown(costs))
    return 0


if __name__ == "__main__":
    sys.exit(main())
