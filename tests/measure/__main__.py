"""``python -m tests.measure WHAT``: what the judge says of the bank, how often it is right, what it says otherwise."""

from __future__ import annotations

import argparse
import importlib
import sys

PROGRAMS = {
    "bank": "judge the bank, and name what is not as expected",
    "evidence": "keep what is seen of each answer of the bank, for the tests that judge it again",
    "mutants": "count the mutants of right answers that are rejected",
    "fresh_drawings": "judge right answers in many drawings that nobody has seen",
    "soak": "judge the bank in random order under load, and name what changes",
    "steady_class": "grade a class thirty times, and name what changes",
    "rates": "all of that, published in docs/accuracy.md",
    "history": "name what the evidence of earlier days says otherwise of the bank; nothing is run",
    "compare": "name what two commits say otherwise of the bank",
    "built_ahead": "record the packages that the course's own notebooks build, so that classes find them built",
    "run_all": "Restart and Run All in one student's folder, again and again",
}
"""What can be asked for; each is the module of that name."""


def main(words: list[str] | None = None) -> int:
    """Run one of the programs; its exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.measure", description=__doc__)
    choices = parser.add_subparsers(required=True, metavar="WHAT")
    for name, about in PROGRAMS.items():
        module = importlib.import_module(f"tests.measure.{name}")
        one = choices.add_parser(name, help=about, description=module.__doc__)
        module.arguments(one)
        one.set_defaults(main=module.main)
    options = parser.parse_args(words)
    code: int = options.main(options)
    return code


if __name__ == "__main__":
    sys.exit(main())
