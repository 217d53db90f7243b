"""Kills a grader at random moments of a batch and looks at what is left: ``python tests/grading/kill_the_grader.py``.

Each round hands in new work for a whole class, starts a batch in a process of its own, ends that process with
``SIGKILL``, ``SIGTERM`` or Ctrl-C at a moment drawn from the time that a batch takes, and asks:

* gradebook and store open and are sound;
* either no grade was touched yet, or each is zero or the right one, never one of an earlier round;
* every process of the batch and of its boxes ends by itself, and no mount of a box is left;
* the same command then finishes the rest, and what was graded before the kill is not run again;
* after it, every grade is right, every page is there, and no file of a submission is left on the disk.

It makes itself the parent of whatever the grader leaves behind, so that nothing gets out of sight.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import psutil

sys.path.insert(0, str(Path(__file__).parent))
from tiny_class import LISTENER, TALKER, TinyClass, make_tiny_class, read_scores

from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.process_trees import adopt_orphans
from tests.cases import cases

BATCH = cases(__file__, "BATCH")
STUDENTS = ("ada", "ben", "cleo", "dora", "emil", "fred", "gwen", "hans")
PATIENCE = 180.0
"""Seconds after which a process that is still there counts as left."""
# Cells of a student's own that would outlive a grader that does not look after them.
DAEMON = "__import__('subprocess').Popen(['sleep', '3600'], start_new_session=True)"

State = dict[str, dict[str, float | None]]


class Violation(AssertionError):
    """Something that must hold after a kill does not."""


@dataclass
class Trial:
    """A class that is graded again and again.

    Attributes:
        tiny: The class.
        temporary: The only folder for temporary files that batches know.
        jobs: Notebooks at once.
        right: The points of the work that is handed in now.
    """

    tiny: TinyClass
    temporary: Path
    jobs: int
    right: State = field(default_factory=dict)

    def hand_in(self, round_number: int) -> None:
        """New work of everybody, worth other points than before."""
        for number, student in enumerate(STUDENTS):
            talker, listener = 1 + (number + round_number) % 9, 1 + (number + 2 * round_number) % 8
            answer: object = talker
            if number == 0:
                answer = f"({DAEMON}, {talker})[1]"
            elif number == 1:
                answer, talker = "1 / 0", 0
            self.tiny.submit(student, answer, listener)
            self.right[student] = {TALKER: float(talker), LISTENER: float(listener)}

    def start(self) -> subprocess.Popen[str]:
        """A batch in a process of its own."""
        environment = os.environ | {
            "TMPDIR": str(self.temporary),
            "PYTHONPATH": os.pathsep.join(
                filter(None, [str(Path(__file__).parent), os.environ.get("PYTHONPATH")])
            ),
        }
        return subprocess.Popen(
            [sys.executable, "-W", "ignore", "-c", BATCH, str(self.tiny.path), str(self.jobs)],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(self) -> int:
        """A batch from start to end; how many notebooks it executed."""
        with self.start() as process:
            said, errors = process.communicate()
        demand(process.returncode == 0, f"the batch ended with {process.returncode}: {errors[-2000:]}")
        return int(said.split()[-1])

    def grades(self) -> State:
        """What the gradebook says, read as a file by somebody who knows nothing of nbgrader."""
        for name in (".autograder/class.db", "gradebook.db"):
            with contextlib.closing(sqlite3.connect(self.tiny.path / name)) as book:
                (sound,) = book.execute("PRAGMA integrity_check").fetchone()
                demand(sound == "ok", f"{name} is damaged: {sound}")
        return read_scores(self.tiny.path)

    def kill_after(self, seconds: float, with_: signal.Signals) -> str:
        """Start a batch, end it, look at what is left, and have the next one finish; a line about it."""
        before = self.grades()
        process = self.start()
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.send_signal(with_)
        process.communicate()
        last = await_orphans()
        demand(not mounts(self.temporary), f"left mounted: {mounts(self.temporary)}")
        left = self.grades()
        untouched = left == before
        wrong = [
            f"{student}'s {cell} has {score}"
            for student, scores in left.items()
            for cell, score in scores.items()
            if score not in (None, 0.0, self.right[student][cell])
        ]
        demand(untouched or not wrong, f"killed after {seconds:.2f} s: {', '.join(wrong)}")
        done = sum(left.get(student) == right for student, right in self.right.items())
        executed = self.run()
        demand(executed <= len(STUDENTS) - (0 if untouched else done), f"{executed} run, {done} were done")
        self.check_finished()
        state = "untouched" if untouched else f"{done} of {len(STUDENTS)} graded"
        when = f"killed after {seconds:5.2f} s by {with_.name}"
        return f"{when}: {state}, {last:.2f} s until all had ended, {executed} run again"

    def check_finished(self) -> None:
        """After a batch that came to its end."""
        demand(self.grades() == self.right, f"the gradebook has {self.grades()} in place of {self.right}")
        for student in STUDENTS:
            page = self.tiny.path / "feedback" / student / "lab_1_2" / "lab_1_2.html"
            demand(page.is_file(), f"{student} has no page")
            with ClassStore(ClassDirectory(self.tiny.path)) as store:
                last = store.attempts(student)[-1]
            scores = {f"{row.exercise.replace('.', '-')}": row.score for row in last.rows}
            demand(scores == self.right[student], f"the last attempt of {student} is noted with {scores}")
        await_orphans()
        left = list(self.temporary.iterdir())
        demand(not left, f"left among the temporary files: {[str(path) for path in left[:10]]}")
        half = sorted(path.name for path in self.tiny.path.rglob("*.new"))
        demand(not half, f"half-written files: {half[:10]}")


def demand(holds: bool, otherwise: str) -> None:
    """Go on only where that holds."""
    if not holds:
        raise Violation(otherwise)


def mounts(folder: Path) -> list[str]:
    """What is mounted in a folder, as everybody outside of the boxes sees it."""
    lines = Path("/proc/self/mountinfo").read_text().splitlines()
    return [line for line in lines if str(folder) in line]


def await_orphans() -> float:
    """Wait until no process of the batch is left; the seconds that took."""
    began = time.monotonic()
    while children := psutil.Process().children(recursive=True):
        if time.monotonic() - began > PATIENCE:
            names = [" ".join(child.cmdline())[:200] for child in children if child.is_running()]
            for child in children:
                with contextlib.suppress(psutil.Error):
                    child.kill()
            raise Violation(f"still there after {PATIENCE:g} s: {names}")
        _, alive = psutil.wait_procs(children, timeout=0.05)
        del alive
    return time.monotonic() - began


def kill_the_grader(folder: Path, kills: int, seed: int, jobs: int) -> None:
    """Kill a grader so many times, each at a moment of its own.

    Args:
        folder: An empty one.
        kills: How often.
        seed: The moments are drawn from it.
        jobs: Notebooks at once.

    Raises:
        Violation: Something did not hold.
    """
    demand(adopt_orphans(), "only Linux lets a process adopt what another leaves behind")
    temporary = folder / "t"
    temporary.mkdir()
    trial = Trial(TinyClass(make_tiny_class(folder)), temporary, jobs)
    trial.hand_in(0)
    began = time.monotonic()
    executed = trial.run()
    whole = time.monotonic() - began
    demand(executed == len(STUDENTS), f"{executed} run")
    trial.check_finished()
    print(f"a batch of {len(STUDENTS)} takes {whole:.2f} s; seed {seed}", flush=True)
    moments = random.Random(seed)
    for round_number in range(1, kills + 1):
        trial.hand_in(round_number)
        with_ = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)[round_number % 3]
        print(trial.kill_after(moments.uniform(0, whole), with_), flush=True)


def main() -> None:
    """Read the options and begin; exit code 1 where something did not hold."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 30))
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="k") as folder:
        try:
            kill_the_grader(Path(folder), options.kills, options.seed, options.jobs)
        except Violation as violation:
            sys.exit(f"VIOLATION (seed {options.seed}): {violation}")
    print(f"{options.kills} passed, 0 failed")


if __name__ == "__main__":
    main()
