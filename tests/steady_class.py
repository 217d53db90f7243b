"""``python -m tests.steady_class``: one class graded thirty times, and what was not the same each time.

Six students hand in six assignments. Five of them answer exercise 1.2 in ways that wait for the service with a limit,
and then make a blocking call without one: who is told that a service is there, and it is not, waits for ever.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from autograder import course
from autograder.authoring.judging import busy_loops
from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.classes.new_class import new_class
from autograder.grading.classes.sample_class import BANK, SampleNotebook, made_notebook
from autograder.grading.rebuilding import nodes

TIMES = 30
"""How often the class is graded."""
ASSIGNMENTS = ("exercise_1_1", "exercise_1_2", "exercise_1_3", "lab_1_2", "lab_1_3", "lab_1_4")
STUDENTS: dict[str, tuple[str, ...]] = {
    "ada": (
        "exercise_1_2.three_ints/right/blocking_call_while_spinning.py",
        "lab_1_2.talker/right/german_qos_profile.py",
        "lab_1_2.listener/right/helper_class.py",
    ),
    "ben": (
        "exercise_1_2.three_ints/right/blocking_call_own_executor.py",
        "exercise_1_3.cancel/right/one_function.py",
        "lab_1_2.talker/right/helper_cell.py",
    ),
    "cem": (
        "exercise_1_2.three_ints/right/blocking_call_polls_for_it.py",
        "exercise_1_3.cancel/right/helper_cell_blocking.py",
        "lab_1_2.listener/right/print_best_effort.py",
    ),
    "dan": (
        "exercise_1_2.three_ints/right/blocking_call_in_a_class.py",
        "exercise_1_3.cancel/wrong/cancel_repeated.py",
        "lab_1_2.talker/wrong/counter_start.py",
    ),
    "eva": (
        "exercise_1_2.three_ints/right/blocking_call_given_terms.py",
        "exercise_1_3.cancel/wrong/status_misreported.py",
        "lab_1_2.listener/wrong/not_logged.py",
    ),
    "fay": (
        "exercise_1_2.three_ints/wrong/one_call_only.py",
        "exercise_1_3.cancel/right/as_hinted.py",
        "lab_1_2.talker/right/stderr_line.py",
    ),
}
"""What each hands in, as files of the bank of notebooks; the master's solution elsewhere."""

Ends = dict[str, str]
"""State, points and diagnosis in a few words, by student and exercise."""


@dataclass(frozen=True)
class Steadiness:
    """What came of grading a class again and again.

    Attributes:
        times: How often it was graded.
        students: How many there are.
        assignments: How many each hands in.
        verdicts: How many verdicts there were in all.
        busy: Busy loops beside it.
        minutes: Wall time.
        changed: Students' exercises that did not come to the same end each time: how often they came to which.
        unexpected: Those whose end is not the one that the bank expects.
    """

    times: int
    students: int
    assignments: int
    verdicts: int
    busy: int
    minutes: float
    changed: dict[str, dict[str, int]] = field(default_factory=dict)
    unexpected: dict[str, str] = field(default_factory=dict)


def make(path: Path) -> None:
    """Make the class, with all that is handed in.

    Raises:
        GradingError: It could not be made.
    """
    new_class(path, course.root(), assignments=ASSIGNMENTS)
    for student, files in STUDENTS.items():
        for assignment in ASSIGNMENTS:
            mine = tuple(file for file in files if file.startswith(f"{assignment}."))
            notebook = made_notebook(path, SampleNotebook(student, assignment, "", {}, bank=mine))
            folder = path / "submitted" / student / assignment
            folder.mkdir(parents=True)
            (folder / f"{assignment}{SUFFIX}").write_text(nodes.text(notebook), encoding="utf-8")


def grade(path: Path, *options: str) -> Ends:
    """Grade the class anew, as a person does.

    Raises:
        RuntimeError: It could not be graded.
    """
    done = subprocess.run(
        [sys.executable, "-m", "autograder", "grade", str(path), "--again", "--json", *options],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, 2) or not done.stdout:
        raise RuntimeError(f"the class could not be graded:\n{done.stderr[-2000:]}")
    report: dict[str, Any] = msgspec.json.decode(done.stdout)
    return {
        f"{one['student']} {verdict['exercise']}": _end(verdict)
        for one in report["submissions"]
        for verdict in one["exercises"]
    }


def _end(verdict: dict[str, Any]) -> str:
    key = verdict["diagnosis"]
    return f"{verdict['state']}, {verdict['score']:g} of {verdict['max_score']:g}{', ' if key else ''}{key}"


def unexpected(ends: Ends) -> dict[str, str]:
    """The ends that are not those that the bank expects, which are full marks where it has no answer of a student's."""
    table = tomllib.loads((course.root() / BANK / "notebooks.toml").read_text(encoding="utf-8"))
    wrong = {}
    for name, end in ends.items():
        student, exercise = name.split()
        mine = [file.split("/") for file in STUDENTS[student] if file.startswith(f"{exercise}/")]
        entry = table[exercise][mine[0][1]][mine[0][2]] if mine else {"verdict": "passed"}
        keys = {entry["diagnosis"], *entry.get("also", ())} if entry["verdict"] == "failed" else {""}
        state, *rest = end.split(", ")
        if state != entry["verdict"] or (rest[1] if len(rest) > 1 else "") not in keys:
            wrong[name] = end
    return wrong


def steadiness(times: int, *, busy: int = 0, options: tuple[str, ...] = ()) -> Steadiness:
    """Make the class in a folder of its own and grade it.

    Args:
        times: How often.
        busy: Busy loops beside it.
        options: More options of ``autograder grade``.

    Raises:
        RuntimeError: It could not be graded.
    """
    began = time.monotonic()
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    wrong: dict[str, str] = {}
    with tempfile.TemporaryDirectory(prefix="steady-") as folder, busy_loops(busy):
        path = Path(folder) / "class"
        make(path)
        for number in range(times):
            ends = grade(path, *options)
            wrong |= unexpected(ends)
            for name, end in ends.items():
                counts[name][end] += 1
            odd = [
                f"{name}: {end}"
                for name, end in sorted(ends.items())
                if len(counts[name]) > 1 or name in wrong
            ]
            print(f"{number + 1} of {times}: {'; '.join(odd) or 'the same'}", file=sys.stderr, flush=True)
    changed = {
        name: dict(ends.most_common())
        for name, ends in sorted(counts.items())
        if len(ends) > 1 or ends.total() != times
    }
    return Steadiness(
        times=times,
        students=len(STUDENTS),
        assignments=len(ASSIGNMENTS),
        verdicts=sum(ends.total() for ends in counts.values()),
        busy=busy,
        minutes=(time.monotonic() - began) / 60,
        changed=changed,
        unexpected=dict(sorted(wrong.items())),
    )


def text(found: Steadiness) -> str:
    """The result as plain text."""
    lines = [
        f"{found.students} students with {found.assignments} assignments, graded {found.times} times in "
        f"{found.minutes:.1f} minutes beside {found.busy} busy loops: {found.verdicts} verdicts, "
        f"{len(found.changed)} changed, {len(found.unexpected)} unexpected"
    ]
    for name, ends in found.changed.items():
        lines.append(
            f"changed: {name}: " + "; ".join(f"{number} times {end}" for end, number in ends.items())
        )
    lines += [f"unexpected: {name}: {end}" for name, end in found.unexpected.items()]
    return "\n".join(lines)


def main() -> int:
    """Grade again and again; 1 where something changed or is not as expected."""
    parser = argparse.ArgumentParser(prog="python -m tests.steady_class", description=__doc__)
    parser.add_argument("--times", type=int, default=TIMES, help="how often the class is graded")
    parser.add_argument("--busy", type=int, default=0, help="busy loops beside it")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    options = parser.parse_args()
    found = steadiness(options.times, busy=options.busy)
    print(msgspec.json.encode(found).decode() if options.json else text(found))
    return 1 if found.changed or found.unexpected else 0


if __name__ == "__main__":
    sys.exit(main())
