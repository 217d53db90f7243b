"""``python -m tests.soak``: the bank judged again and again in random order under load, and what changes then.

The same answer must come to the same points and the same diagnosis each time, whatever the inputs, the order and the
machine's load. A diagnosis that is only one of several right ones is no excuse: it must be the same one.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from random import Random
from typing import TYPE_CHECKING

import msgspec

from autograder.authoring.answers import Answer, answers
from autograder.authoring.judging import Turn, busy_loops, judge_all, warm_up

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.verdict import Verdict

JUDGEMENTS = 1_000
"""Judgements of a soak."""


@dataclass(frozen=True)
class Soak:
    """What came of a soak.

    Attributes:
        judgements: How many there were.
        answers: How many answers these were of.
        repeated: How many of these were judged more than once, without which nothing can change.
        jobs: How many were judged at once.
        busy: Busy loops beside them.
        seed: What order and inputs were drawn from.
        minutes: Wall time.
        changed: Answers that did not come to the same end each time: how often they came to which.
        unexpected: Answers whose end is not the one that the bank expects, and what it was.
    """

    judgements: int
    answers: int
    repeated: int
    jobs: int
    busy: int
    seed: int
    minutes: float
    changed: dict[str, dict[str, int]] = field(default_factory=dict)
    unexpected: dict[str, str] = field(default_factory=dict)


def drawn(wanted: Sequence[Answer], number: int, seed: int, *, same_inputs: bool) -> list[Turn[Answer]]:
    """Turns in random order, of each answer as many as of any other, give or take one.

    Args:
        wanted: The answers.
        number: How many turns.
        seed: Decides on order and inputs.
        same_inputs: Give all turns of an answer the same inputs.
    """
    random = Random(seed)
    turns: list[Turn[Answer]] = []
    while wanted and len(turns) < number:
        lap = len(turns) // len(wanted)
        inputs = f"soak {seed}" if same_inputs else f"soak {seed}, lap {lap}"
        turns += [Turn(answer, inputs) for answer in random.sample(list(wanted), len(wanted))]
    turns = turns[:number]
    random.shuffle(turns)
    return turns


def soak(
    wanted: Sequence[Answer], number: int, *, jobs: int, busy: int, seed: int, same_inputs: bool = False
) -> Soak:
    """Judge answers of the bank in random order; this process must have no threads, and becomes warm.

    Args:
        wanted: The answers.
        number: How many judgements.
        jobs: How many at once.
        busy: Busy loops beside them.
        seed: Decides on order and inputs.
        same_inputs: Give all judgements of an answer the same inputs.
    """
    began = time.monotonic()
    ends: dict[str, Counter[str]] = defaultdict(Counter)
    unexpected: dict[str, str] = {}

    def done(turn: Turn[Answer], verdict: Verdict) -> None:
        name, end = turn.subject.name, end_of(verdict)
        if ends[name] and end not in ends[name]:
            print(f"{name}: {end}, not {next(iter(ends[name]))}", file=sys.stderr, flush=True)
        ends[name][end] += 1
        if objection := turn.subject.objection(verdict):
            unexpected[name] = objection

    def failed(turn: Turn[Answer], trouble: str) -> None:
        ends[turn.subject.name][f"no verdict: {trouble}"] += 1

    turns = drawn(wanted, number, seed, same_inputs=same_inputs)
    with busy_loops(busy):
        warm_up()
        judge_all(turns, jobs=jobs, done=done, warm=True, failed=failed)
    changed = {name: dict(counts.most_common()) for name, counts in sorted(ends.items()) if len(counts) > 1}
    minutes = (time.monotonic() - began) / 60
    repeated = sum(counts.total() > 1 for counts in ends.values())
    return Soak(
        len(turns), len(ends), repeated, jobs, busy, seed, minutes, changed, dict(sorted(unexpected.items()))
    )


def end_of(verdict: Verdict) -> str:
    """State, points and diagnosis in a few words: what must not change."""
    key = verdict.diagnosis.key if verdict.diagnosis else ""
    return f"{verdict.state}, {verdict.score:g} of {verdict.max_score:g}{', ' if key else ''}{key}"


def text(found: Soak) -> str:
    """The result as plain text."""
    lines = [
        f"{found.judgements} judgements of {found.answers} answers ({found.repeated} more than once) in "
        f"{found.minutes:.1f} minutes, {found.jobs} at a time beside {found.busy} busy loops: "
        f"{len(found.changed)} changed, {len(found.unexpected)} unexpected"
    ]
    lines += [f"changed: {name}: {_counts(counts)}" for name, counts in found.changed.items()]
    lines += [f"unexpected: {name}: {why}" for name, why in found.unexpected.items()]
    return "\n".join(lines)


def _counts(counts: Mapping[str, int]) -> str:
    return "; ".join(f"{number} times {end}" for end, number in counts.items())


def main() -> int:
    """Soak; 1 where something changed or is not as expected."""
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description=__doc__)
    parser.add_argument("only", nargs="*", help="parts of the names of answers, such as lab_1_4 or /wrong/")
    parser.add_argument("--judgements", type=int, default=JUDGEMENTS, help="how many there are in all")
    parser.add_argument("--repeat", type=int, help="judge each answer so often, instead of a number in all")
    parser.add_argument("--jobs", type=int, default=8, help="how many are judged at once")
    parser.add_argument("--busy", type=int, default=2, help="busy loops beside them")
    parser.add_argument("--seed", type=int, default=0, help="what order and inputs are drawn from")
    parser.add_argument("--same-inputs", action="store_true", help="the same inputs for an answer each time")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    options = parser.parse_args()
    wanted = [a for a in answers() if not options.only or any(part in a.name for part in options.only)]
    found = soak(
        wanted,
        options.repeat * len(wanted) if options.repeat else options.judgements,
        jobs=options.jobs,
        busy=options.busy,
        seed=options.seed,
        same_inputs=options.same_inputs,
    )
    print(msgspec.json.encode(found).decode() if options.json else text(found))
    return 1 if found.changed or found.unexpected else 0


if __name__ == "__main__":
    sys.exit(main())
