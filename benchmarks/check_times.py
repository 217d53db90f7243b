"""``python -m benchmarks.check_times [LAB ...]``: wall and CPU seconds of each check of an honest student."""

from __future__ import annotations

import argparse

from autograder.safe_files import HeldFolder
from benchmarks.classes import make_class
from benchmarks.floor import builds, measure_floor


def main(labs: tuple[str, ...]) -> None:
    """Print a table of the checks in some labs, or in all; checks that build a workspace are marked."""
    print("| check | seconds | CPU seconds |\n| --- | --- | --- |")
    with HeldFolder("autograder-bench-") as held:
        made = make_class(held.path / "class", 1, labs)
        for notebook in measure_floor(made, made.students):
            for _, seconds, cpu, exercise in notebook.cells:
                if exercise:
                    print(f"| {exercise}{', builds' * builds(exercise)} | {seconds:.2f} | {cpu:.2f} |")


if __name__ == "__main__":
    options = argparse.ArgumentParser(prog="python -m benchmarks.check_times", description=__doc__)
    options.add_argument(
        "labs", nargs="*", metavar="LAB", help="only the checks of these labs, such as lab_1_2"
    )
    main(tuple(options.parse_args().labs))
