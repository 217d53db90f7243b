"""A program that judges the whole bank of right and wrong answers.

By hand: ``python tests/judge/bank.py --repeat 10 --busy 2`` judges everything ten times beside two busy loops and
prints what did not come out as expected. ``python tests/judge/bank.py --print lab_1_2.talker/wrong/counter_start``
prints the program of an answer, which may be stored as an edit (``autograder.authoring.answer_tables``).
"""

from __future__ import annotations

import argparse
import sys
import time
from typing import TYPE_CHECKING

from autograder.authoring.answers import COLD, Answer, answers, longest_first
from autograder.authoring.judging import Turn, busy_loops, judge_all, warm_up

if TYPE_CHECKING:
    from autograder.verdict import Verdict


def main(words: list[str]) -> int:
    """Judge the bank, perhaps several times, perhaps under load."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help="parts of the names of answers")
    parser.add_argument("--print", action="store_true", help="print the programs, judge none")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--busy", type=int, default=0, help="busy loops beside it")
    parser.add_argument("--jobs", type=int, default=14)
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
    chosen = parser.parse_args(words)
    wanted = [a for a in answers() if not chosen.only or any(part in a.name for part in chosen.only)]
    if chosen.print:
        for answer in wanted:
            print(f"# {answer.name}\n" * (len(wanted) > 1) + answer.text, end="")
        return 0 if wanted else 1
    objections = 0

    def done(turn: Turn[Answer], verdict: Verdict) -> None:
        nonlocal objections
        answer = turn.subject
        if chosen.lines:
            from autograder.verdict import to_json

            print(answer.name, to_json(verdict).decode(), flush=True)
            return
        objection = answer.objection(verdict)
        objections += bool(objection)
        if objection or (chosen.slow and verdict.seconds >= chosen.slow):
            print(f"{answer.name}: {objection or 'as expected'} ({verdict.seconds:.1f} s)", flush=True)

    with busy_loops(chosen.busy):
        warm_up()
        for number in range(chosen.repeat):
            began = time.monotonic()
            turns = [Turn(answer, f"turn {number}") for answer in longest_first(wanted)]
            judge_all(turns, jobs=chosen.jobs, done=done, warm=chosen.warm)
            if not chosen.lines:
                print(
                    f"turn {number + 1}: {len(wanted)} answers in {time.monotonic() - began:.0f} s, {objections} "
                    f"objections"
                )
    return 1 if objections else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
