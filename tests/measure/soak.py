"""The bank judged again and again in random order under load, and what changes then.

The same answer must come to the same points and the same diagnosis each time, whatever the inputs, the order and the
machine's load. A diagnosis that is only one of several right ones is no excuse: it must be the same one.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import time
from random import Random
from typing import TYPE_CHECKING

import msgspec

from autograder.authoring.answer_bank import Turn, judge_all, warm_up
from autograder.process_trees import die_with_parent
from tests.measure import bank
from tests.measure.ends import Ends, Repeated, end_of

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Sequence

    from autograder.authoring.answer_bank import Answer
    from autograder.verdict import Verdict


@contextlib.contextmanager
def busy_loops(number: int) -> Iterator[None]:
    """Keep so many processors busy as long as the block runs."""
    loops = [multiprocessing.Process(target=_busy, daemon=True) for _ in range(number)]
    for loop in loops:
        loop.start()
    try:
        yield
    finally:
        for loop in loops:
            loop.terminate()


def _busy() -> None:
    die_with_parent(os.getppid())
    while True:
        pass


EACH = 4
"""Times that an answer is judged at least: one that was judged once shows no change."""


def drawn(wanted: Sequence[Answer], number: int, seed: int, *, same_inputs: bool) -> list[Turn[Answer]]:
    """Turns in random order, of each answer as many as of any other, give or take one.

    Where there are too many answers to judge each again and again, some are drawn.

    Args:
        wanted: The answers.
        number: How many turns.
        seed: Decides on order and inputs.
        same_inputs: Give all turns of an answer the same inputs.
    """
    random = Random(seed)
    wanted = random.sample(wanted, min(len(wanted), -(-number // EACH)))
    turns: list[Turn[Answer]] = []
    while wanted and len(turns) < number:
        lap = len(turns) // len(wanted)
        inputs = f"soak {seed}" if same_inputs else f"soak {seed}, lap {lap}"
        turns += [Turn(answer, inputs) for answer in random.sample(wanted, len(wanted))]
    turns = turns[:number]
    random.shuffle(turns)
    return turns


def soak(turns: Sequence[Turn[Answer]], *, jobs: int, busy: int) -> Repeated:
    """Judge answers of the bank in this order; this process must have no threads.

    Args:
        turns: The answers, and their inputs.
        jobs: How many at once.
        busy: Busy loops beside them.
    """
    began = time.monotonic()
    ends = Ends()

    def done(turn: Turn[Answer], verdict: Verdict) -> None:
        ends.add(turn.subject.name, end_of(verdict), turn.subject.objection(verdict))

    def failed(turn: Turn[Answer], trouble: str) -> None:
        ends.add(turn.subject.name, f"no verdict: {trouble}")

    with busy_loops(busy):
        warm_up()
        judge_all(turns, jobs=jobs, done=done, failed=failed)
    return ends.result((time.monotonic() - began) / 60, f"{jobs} at a time beside {busy} busy loops")


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    bank.of_answers(parser, jobs=8)
    parser.add_argument("--judgements", type=int, default=1_000, help="how many there are in all")
    parser.add_argument("--busy", type=int, default=2, help="busy loops beside them")
    parser.add_argument("--seed", type=int, default=0, help="what answers, order and inputs are drawn from")
    parser.add_argument("--same-inputs", action="store_true", help="the same inputs for an answer each time")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def main(options: argparse.Namespace) -> int:
    """Soak; 1 where something changed or is not as expected."""
    wanted = bank.chosen(options.only)
    turns = drawn(wanted, options.judgements, options.seed, same_inputs=options.same_inputs)
    found = soak(turns, jobs=options.jobs, busy=options.busy)
    print(msgspec.json.encode(found).decode() if options.json else found.text())
    return 1 if found.changed or found.unexpected else 0
