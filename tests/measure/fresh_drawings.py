"""Whether each right answer of the bank passes in many drawings of its exercise that nobody has seen.

The solution says on paper what is right in them. An answer runs on paper, too; one that paper rejects or cannot run is
watched by the judge, in all drawings in one process, and only the judge rejects.
"""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import msgspec

from autograder import exercises
from autograder.authoring.answer_bank import Answer, answers, in_children, warm_up
from autograder.authoring.mutants.solutions import solution
from autograder.authoring.mutants.trials import NotOnPaper, PaperTask, paper_task, run_all
from autograder.judge import evidence_files
from autograder.judge.ros_setup import lease_domain, prepare_judge
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Sequence

LIMIT = 600.0
"""Seconds of wall time for the judge to watch one answer in all drawings."""
ON_PAPER = """
from tests.measure.fresh_drawings import run_program

class {root}:
    def __init__(self):
        run_program({text!r})
"""


class _Spins(BaseException):
    """The program has made its nodes."""


def run_program(text: str) -> None:
    """Run a program on paper until it spins."""
    import rclpy
    import rclpy.executors

    from autograder.authoring.paper.nodes import PaperNode

    class Executor:
        def __init__(self, *_: Any, **__: Any) -> None:
            pass

        def add_node(self, _: Any) -> None:
            pass

        @staticmethod
        def spin(*_: Any) -> None:
            raise _Spins

        def shutdown(self, *_: Any) -> None:
            pass

    there: dict[str, Any] = {"init": Executor, "create_node": PaperNode, "spin": Executor.spin}
    there |= dict.fromkeys(("shutdown", "try_shutdown"), Executor)
    for name, value in there.items():
        setattr(rclpy, name, value)
    for name in ("SingleThreadedExecutor", "MultiThreadedExecutor"):
        setattr(rclpy.executors, name, Executor)
    setattr(PaperNode, "destroy_node", lambda _: None)  # noqa: B010  (for this process alone)
    try:
        exec(compile(text, "answer", "exec"), {"__name__": "__main__"})
    except _Spins:
        return
    raise RuntimeError("the program ends, or spins in its own way")


def by_judge(task: PaperTask, answer: Answer, names: Sequence[str]) -> bytes:
    """Return the drawings in which the judge rejects an answer, each with what it says; one check for each."""
    prepare_judge()
    from autograder.judge.one_check import check
    from autograder.judge.subject import CommandSubject

    lost = []
    with HeldFolder("autograder-answer-") as folder, lease_domain() as domain_id:
        subject = CommandSubject(answer.unpack(folder.path))
        for name in names:
            drawn = [part for part in task.reference.parts if part.name == name]
            reference = replace(task.reference, parts=drawn)
            found = check(
                task.exercise, subject, reference, seed=name, domain_id=domain_id, marks_crowded=True
            )
            if not found.verdict.passed:
                lost.append(f"{name}: {answer.objection(found.verdict)}{' (crowded)' * found.crowded}")
    return msgspec.json.encode(lost)


def rejected(exercise_id: str, *, drawings: int, by_judge_too: int, jobs: int) -> Iterator[tuple[str, str]]:
    """Yield how each right answer fares: its name, and "paper", "judge", or what the judge rejects and why.

    Args:
        exercise_id: The exercise's id.
        drawings: The number of fresh drawings on paper.
        by_judge_too: The number of them in which the judge watches an answer that paper does not accept.
        jobs: The number of answers at the same time.

    Raises:
        NotOnPaper: The solution cannot be run on paper, so nothing says what is right in a fresh drawing.
    """
    found = solution(exercise_id)
    if found is None:
        raise NotOnPaper("no master has a solution of it")
    exercise, stored = exercises.get(exercise_id), evidence_files.load_reference(exercise_id)
    task = paper_task(exercise, stored, found.text, found.root, fresh=drawings)
    right = [answer for answer in answers([exercise_id]) if not answer.diagnoses]
    programs = ((one, ON_PAPER.format(root=found.root, text=one.text)) for one in right)
    left = []
    for answer, runs in run_all(task, programs, jobs=jobs):
        if len(runs) == len(task.practice) + drawings and all(run.passed for run in runs):
            yield answer.name, "paper"
        else:
            left.append(answer)
    names = task.fresh[:by_judge_too]
    works = ((one, partial(by_judge, task, one, names)) for one in left)
    for answer, outcome in in_children(works, jobs=jobs, limit=LIMIT):
        lost = msgspec.json.decode(outcome.data) if outcome.data else [f"not judged: {outcome.trouble}"]
        yield answer.name, "; ".join(lost) or "judge"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    parser.add_argument("exercises", nargs="*", help="all that draw their inputs by default")
    parser.add_argument("--drawings", type=int, default=20, help="on paper, for each answer")
    parser.add_argument("--judge", type=int, default=20, help="by the judge, for each that is not on paper")
    parser.add_argument("--jobs", type=int, default=2, help="answers at once")


def main(options: argparse.Namespace) -> int:
    """Try right answers; 1 if one is rejected."""
    warm_up()
    drawn = [one.id for one in exercises.unbroken() if one.is_drawn and not one.hides_causes]
    bad = 0
    for exercise_id in options.exercises or drawn:
        began, fates = time.monotonic(), Counter[str]()
        try:
            for name, fate in rejected(
                exercise_id, drawings=options.drawings, by_judge_too=options.judge, jobs=options.jobs
            ):
                fates[fate if fate in ("paper", "judge") else "rejected"] += 1
                if fate not in ("paper", "judge"):
                    print(f"{name}: {fate}", flush=True)
        except NotOnPaper as why:
            print(f"{exercise_id}: not tried: {why}", flush=True)
            continue
        bad += fates["rejected"]
        counts = ", ".join(f"{fates[one]} {one}" for one in ("paper", "judge", "rejected"))
        print(f"{exercise_id}: {counts} ({time.monotonic() - began:.0f} s)", flush=True)
    return 1 if bad else 0
