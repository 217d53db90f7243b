"""The bank of right and wrong answers as data, and a program that judges it.

By hand: ``python tests/judge/bank.py --repeat 10 --busy 2`` judges everything ten times beside two busy loops
and
prints what did not come out as expected.
"""

from __future__ import annotations

import argparse
import multiprocessing
import select
import sys
import tempfile
import time
import tomllib
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.verdict import State, Verdict, from_json

sys.path.insert(0, str(Path(__file__).parent))
from workspace_answers import unpack

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from autograder.exercises.model import Exercise

_PROGRAMS = {"python3": sys.executable, "ros2": str(Path(sys.executable).with_name("ros2"))}
"""The programs that answers are run with, those of this environment."""

ROOT = Path(__file__).resolve().parents[1] / "submissions"


@dataclass(frozen=True)
class Answer:
    """One program of the bank and what the judge must find.

    Attributes:
        exercise: The exercise's id.
        file: The program.
        command: What runs it, with places for ``{file}`` and ``{workspace}``.
        diagnoses: The keys that are right; empty for a correct answer.
        base: The workspace that the answer changes; None for a program.
    """

    exercise: str
    file: Path
    command: tuple[str, ...]
    diagnoses: tuple[str, ...]
    base: Path | None = None

    @property
    def name(self) -> str:
        """Such as ``lab_1_2.talker/wrong/topic_name.py``."""
        return f"{self.exercise}/{self.file.parent.name}/{self.file.name}"

    @property
    def may_be_warm(self) -> bool:
        """Whether it is a plain Python program, and not one of those that are always started from nothing."""
        plain = self.base is None and self.command == (sys.executable, "{file}")
        return plain and zlib.crc32(self.name.encode()) % COLD != 0

    def objection(self, verdict: Verdict) -> str:
        """What is not as expected, or an empty string."""
        key = verdict.diagnosis.key if verdict.diagnosis else ""
        if not self.diagnoses:
            missed = "; ".join(f"{c.name}: {c.seen}" for c in verdict.criteria if not c.passed)
            return "" if verdict.passed else f"a correct answer got {verdict.score:g} ({key}: {missed})"
        if verdict.state != "failed":
            return f"a wrong answer is {verdict.state}"
        if verdict.score >= verdict.max_score:
            return "a wrong answer got full marks"
        return "" if key in self.diagnoses else f"diagnosed as {key}, not as {' or '.join(self.diagnoses)}"


def answers() -> Iterator[Answer]:
    """Every program of the bank."""
    for expected in sorted(ROOT.glob("*/expected.toml")):
        table = tomllib.loads(expected.read_text(encoding="utf-8"))
        for kind in ("correct", "wrong"):
            for name, entry in table.get(kind, {}).items():
                file = expected.parent / kind / name
                first, *rest = entry.get("command", table.get("command", ["python3", "{file}"]))
                command = (_PROGRAMS.get(first, first), *rest)
                diagnoses = (entry["diagnosis"], *entry.get("also", ())) if kind == "wrong" else ()
                base = expected.parent / table["base"] if file.suffix == ".workspace" else None
                yield Answer(table["exercise"], file, command, diagnoses, base)


COLD = 6
"""One program in so many is always run as everybody runs programs, in a process that begins with nothing."""


def judge_all(
    wanted: Sequence[Answer],
    *,
    jobs: int,
    seed: str,
    done: Callable[[Answer, Verdict], None],
    warm: bool = False,
) -> None:
    """Judge answers in forks of this process, which must have no other threads.

    Args:
        wanted: What to judge.
        jobs: How many at once.
        seed: What random inputs are drawn from.
        done: Called with each verdict as it comes.
        warm: Run most programs in forks of a process that has imported ROS.
    """
    from autograder import exercises
    from autograder.judge.fork import Child

    # Those that may take long come first, so that none of them is waited for alone at the end.
    waiting = sorted(wanted, key=lambda answer: -exercises.get(answer.exercise).limit)
    again: list[Answer] = []
    running: dict[int, tuple[Answer, Child]] = {}
    while waiting or running:
        while waiting and len(running) < jobs:
            answer = waiting.pop(0)
            child = Child(lambda answer=answer: _judged(answer, seed, warm), 240.0)  # type: ignore[misc]
            running[child.reading] = (answer, child)
        ready, _, _ = select.select(list(running), [], [])
        for descriptor in ready:
            answer, child = running.pop(descriptor)
            outcome = child.result()
            verdict = from_json(outcome.data) if outcome.data is not None else None
            if verdict is not None and (verdict.state != State.NOT_CHECKED or answer in again):
                done(answer, verdict)
            elif answer in again:
                raise RuntimeError(f"{answer.name}: {outcome.trouble}")
            else:
                # Without a verdict nothing is known. It is asked for once more, when less is going on.
                again.append(answer)
                waiting.append(answer)


def _judged(answer: Answer, seed: str, warm: bool) -> bytes:
    from autograder import exercises
    from autograder.judge.command import judged_here
    from autograder.verdict import to_json

    exercise = exercises.get(answer.exercise)
    with tempfile.TemporaryDirectory(prefix="answer-") as folder:
        workspace = Path(folder) / "ros2_ws"
        if answer.base is not None:
            unpack(answer.file, answer.base, workspace)
        command = [part.format(file=answer.file, workspace=workspace) for part in answer.command]
        if warm and answer.may_be_warm and not exercise.wraps_commands:
            return to_json(_judged_warm(exercise, command, seed))
        return to_json(judged_here(exercise, command, seed, None))


def _judged_warm(exercise: Exercise, command: Sequence[str], seed: str) -> Verdict:
    """The same as ``judged_here``, with the program in a fork of this process."""
    from warm_python import WarmPython, WarmScript

    from autograder.judge import domain, reference, trial
    from autograder.judge.wire import JudgeFailed
    from autograder.verdict import not_checked

    subject = WarmScript(WarmPython(), command)
    try:
        with domain.lease() as domain_id:
            return trial.check(exercise, subject, reference.load(exercise.id), seed=seed, domain_id=domain_id)
    except JudgeFailed as error:
        return not_checked(exercise.id, exercise.title, exercise.points, str(error))


def warm_up() -> None:
    """Import in this process what every fork needs."""
    from autograder.judge import settings

    settings.prepare_judge()
    from autograder.judge import warm

    warm.imports()


def _busy() -> None:
    while True:
        pass


def main() -> int:
    """Judge the bank, perhaps several times, perhaps under load."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help="parts of the names of answers")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--busy", type=int, default=0, help="busy loops beside it")
    parser.add_argument("--jobs", type=int, default=8)
    parser.add_argument(
        "--warm",
        action="store_true",
        help=f"run all but one program in {COLD} in forks that know ROS already",
    )
    parser.add_argument(
        "--lines", action="store_true", help="print each verdict as a line of JSON (for the tests)"
    )
    parser.add_argument(
        "--slow", type=float, default=0.0, help="also name checks of at least so many seconds"
    )
    chosen = parser.parse_args()
    wanted = [a for a in answers() if not chosen.only or any(part in a.name for part in chosen.only)]
    loops = [multiprocessing.Process(target=_busy, daemon=True) for _ in range(chosen.busy)]
    for loop in loops:
        loop.start()
    warm_up()
    objections = 0

    def done(answer: Answer, verdict: Verdict) -> None:
        nonlocal objections
        if chosen.lines:
            from autograder.verdict import to_json

            print(answer.name, to_json(verdict).decode(), flush=True)
            return
        objection = answer.objection(verdict)
        objections += bool(objection)
        if objection or (chosen.slow and verdict.seconds >= chosen.slow):
            print(f"{answer.name}: {objection or 'as expected'} ({verdict.seconds:.1f} s)", flush=True)

    for turn in range(chosen.repeat):
        began = time.monotonic()
        judge_all(wanted, jobs=chosen.jobs, seed=f"turn {turn}", done=done, warm=chosen.warm)
        if not chosen.lines:
            print(
                f"turn {turn + 1}: {len(wanted)} answers in {time.monotonic() - began:.0f} s, {objections} "
                f"objections"
            )
    for loop in loops:
        loop.terminate()
    return 1 if objections else 0


if __name__ == "__main__":
    sys.exit(main())
