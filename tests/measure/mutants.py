"""How many mutants of right answers the judge catches, and which survive."""

from __future__ import annotations

import secrets
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder.authoring.answer_bank import warm_up
from tests.mutation import equivalents
from tests.mutation.report import text
from tests.mutation.results import Fate, Result
from tests.mutation.run import chosen, run

if TYPE_CHECKING:
    import argparse


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    parser.add_argument("only", nargs="*", help="parts of the ids, such as lab_1_2.talker or :number:")
    parser.add_argument("--sample", type=int, metavar="N", help="only N mutants, of every exercise as many")
    parser.add_argument("--seed", type=int, help="which are in the sample; another one each time by default")
    parser.add_argument("--jobs", type=int, default=14, help="how many are judged at once")
    parser.add_argument("--repeat", type=int, default=1, help="with how many different inputs each is judged")
    parser.add_argument(
        "--results", type=Path, metavar="FILE", help="keep results, and go on with those it has"
    )
    parser.add_argument("--list", action="store_true", help="show the mutants, and judge nothing")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")


def main(options: argparse.Namespace) -> int:
    """Judge mutants; 1 where one survives that is not entered as equivalent."""
    seed = secrets.randbelow(100_000) if options.seed is None else options.seed
    print(f"seed {seed}", file=sys.stderr, flush=True)
    if options.list:
        for mutant in chosen(options.only, options.sample, seed)[1]:
            print(mutant.id, equivalents.reason(mutant.id), mutant.difference(), "", sep="\n")
        return 0
    warm_up()

    def told(result: Result) -> None:
        if result.fate is not Fate.KILLED and not equivalents.reason(result.id):
            print(f"{result.fate}: {result.id} ({result.seconds:.1f} s)", file=sys.stderr, flush=True)

    found = run(
        options.only,
        size=options.sample,
        seed=seed,
        jobs=options.jobs,
        repeat=options.repeat,
        file=options.results,
        told=told,
    )
    print(msgspec.json.encode(found).decode() if options.json else text(found))
    return 1 if found.survivors or found.caught_equivalents else 0
