"""The bank of right and wrong answers, each judged once, and what did not come out as expected.

``--print lab_1_2.talker/wrong/counter_start`` prints the program of an answer instead, which may be stored as an edit
(``autograder.authoring.answer_tables``). To judge answers again and again, under load: ``soak``.
"""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.authoring.answer_bank import Answer, Turn, answers, judge_all, warm_up
from autograder.verdict import to_json

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable, Sequence

    from autograder.verdict import Verdict


def of_answers(parser: argparse.ArgumentParser, *, jobs: int = 14) -> None:
    """The options of all programs that judge answers."""
    parser.add_argument("only", nargs="*", help="parts of the names of answers, such as lab_1_4 or /wrong/")
    parser.add_argument("--jobs", type=int, default=jobs, help="how many are judged at once")


def chosen(only: Sequence[str]) -> list[Answer]:
    """The answers with one of these parts in their names; all where there is none."""
    return [answer for answer in answers() if not only or any(part in answer.name for part in only)]


def answer_named(name: str) -> Answer:
    """Return the answer with a name such as ``lab_1_2.talker/wrong/topic_name.py``.

    Raises:
        StopIteration: The answer does not exist.
    """
    return next(answer for answer in answers() if answer.name == name)


def longest_first(wanted: Iterable[Answer]) -> list[Answer]:
    """Sort answers so that slow ones start first. Otherwise a slow answer could run alone at the end."""
    return sorted(wanted, key=lambda answer: -exercises.get(answer.exercise).limit)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    of_answers(parser)
    parser.add_argument("--print", action="store_true", help="print the programs, judge none")
    parser.add_argument(
        "--lines",
        action="store_true",
        help="print each verdict as a line of JSON; whoever reads them judges them",
    )


def main(options: argparse.Namespace) -> int:
    """Judge the bank; 1 where something is not as expected."""
    wanted = chosen(options.only)
    if options.print:
        for answer in wanted:
            print(f"# {answer.name}\n" * (len(wanted) > 1) + answer.text, end="")
        return 0 if wanted else 1
    objections = []

    def done(turn: Turn[Answer], verdict: Verdict) -> None:
        if options.lines:
            print(turn.subject.name, to_json(verdict).decode(), flush=True)
        elif objection := turn.subject.objection(verdict):
            objections.append(objection)
            print(f"{turn.subject.name}: {objection} ({verdict.seconds:.1f} s)", flush=True)

    def failed(turn: Turn[Answer], trouble: str) -> None:
        objections.append(trouble)
        print(f"{turn.subject.name}: no verdict, twice: {trouble}", file=sys.stderr, flush=True)

    began = time.monotonic()
    warm_up()
    turns = [Turn(answer, "turn 0") for answer in longest_first(wanted)]
    judge_all(turns, jobs=options.jobs, done=done, failed=failed)
    if not options.lines:
        print(f"{len(wanted)} answers in {time.monotonic() - began:.0f} s, {len(objections)} objections")
    return 1 if objections and not options.lines else 0
