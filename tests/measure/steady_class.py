"""One class graded thirty times, and what was not the same each time.

Six students hand in six assignments. Five of them answer exercise 1.2 in ways that wait for the service with a limit,
and then make a blocking call without one: who is told that a service is there, and it is not, waits for ever.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from autograder import course
from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.new_classes.new_class import new_class
from tests.measure.ends import Ends, Repeated, in_one_line
from tests.measure.soak import busy_loops
from tests.submissions.odd_notebooks import BANK, OddNotebook, text_of

if TYPE_CHECKING:
    import argparse

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
        "exercise_1_3.cancel/wrong/status_not_reported.py",
        "lab_1_2.listener/wrong/not_logged.py",
    ),
    "fay": (
        "exercise_1_2.three_ints/wrong/one_call_only.py",
        "exercise_1_3.cancel/right/as_hinted.py",
        "lab_1_2.talker/right/stderr_line.py",
    ),
}
"""What each hands in, as files of the bank of notebooks; the master's solution elsewhere."""


def make(path: Path) -> None:
    """Make the class, with all that is handed in.

    Raises:
        GradingError: It could not be made.
    """
    new_class(path, course.root(), assignments=ASSIGNMENTS)
    for student, files in STUDENTS.items():
        for assignment in ASSIGNMENTS:
            mine = tuple(file for file in files if file.startswith(f"{assignment}."))
            text = text_of(path, OddNotebook(student, assignment, "", {}, bank=mine))
            folder = path / "submitted" / student / assignment
            folder.mkdir(parents=True)
            (folder / f"{assignment}{SUFFIX}").write_text(text, encoding="utf-8")


def grade(path: Path, *options: str) -> dict[str, str]:
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
        raise RuntimeError(
            f"the class could not be graded (exit code {done.returncode}):\n{done.stderr[-2000:]}"
        )
    report: dict[str, Any] = msgspec.json.decode(done.stdout)
    return {
        f"{one['student']} {verdict['exercise']}": in_one_line(
            verdict["state"], verdict["score"], verdict["max_score"], verdict["diagnosis"]
        )
        for one in report["submissions"]
        for verdict in one["exercises"]
    }


def unexpected(ends: dict[str, str]) -> dict[str, str]:
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


def steadiness(times: int, *, busy: int = 0, options: tuple[str, ...] = ()) -> Repeated:
    """Make the class in a folder of its own and grade it.

    Args:
        times: How often.
        busy: Busy loops beside it.
        options: More options of ``autograder grade``.

    Raises:
        RuntimeError: It could not be graded.
    """
    began = time.monotonic()
    counted = Ends()
    with tempfile.TemporaryDirectory(prefix="steady-") as folder, busy_loops(busy):
        path = Path(folder) / "class"
        make(path)
        for number in range(times):
            ends = grade(path, *options)
            wrong = unexpected(ends)
            for name, end in ends.items():
                counted.add(name, end, wrong.get(name, ""))
            print(f"{number + 1} of {times}, {len(wrong)} unexpected", file=sys.stderr, flush=True)
    how = f"{len(STUDENTS)} students, {len(ASSIGNMENTS)} assignments, {times} times beside {busy} busy loops"
    return counted.result((time.monotonic() - began) / 60, how)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    parser.add_argument("--times", type=int, default=30, help="how often the class is graded")
    parser.add_argument("--busy", type=int, default=0, help="busy loops beside it")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def main(options: argparse.Namespace) -> int:
    """Grade again and again; 1 where something changed or is not as expected."""
    found = steadiness(options.times, busy=options.busy)
    print(msgspec.json.encode(found).decode() if options.json else found.text())
    return 1 if found.changed or found.unexpected else 0
