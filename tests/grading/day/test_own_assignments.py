"""Assignments of an instructor's own, with plain tests, are executed in boxes and graded by nbgrader's rules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat
import pytest
from nbgrader.api import Gradebook
from own_assignment import TESTS, graded_cells, hand_in, write_assignment

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import CellCheck, CellRun
from autograder.execution.verdicts_without_judge import verdict_by_tests
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.new_classes.new_class import release

if TYPE_CHECKING:
    from tiny_class import TinyClass


def points(tiny: TinyClass, student: str) -> dict[str, float]:
    """The table, which has to say what the gradebook says."""
    rows = [row for row in tiny.table() if row["student"] == student]
    found = {row["exercise"]: float(row["score"]) for row in rows}
    with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
        total = sum(one.score for one in book.student_submissions(student))
    assert sum(found.values()) == total
    return found


def test_an_own_assignment_is_graded_by_its_tests(tiny: TinyClass, with_fake_judge: str) -> None:
    write_assignment(tiny)
    hand_in(tiny, "ada", "def add(a, b):\n    return a + b")
    hand_in(tiny, "ben", "def add(a, b):\n    return abs(a) - abs(b)")
    hand_in(tiny, "eve", "import os\nos._exit(0)")
    hand_in(tiny, "joe", "def add(a, b:")
    report = tiny.grade(judge=with_fake_judge, feedback=True)
    assert report.exit_code == 0
    assert points(tiny, "ada") == {"small": 2, "noisy": 3, "partial": 1.5, "hidden": 1}
    assert points(tiny, "ben") == {"small": 0, "noisy": 3, "partial": 0.5, "hidden": 0}
    assert points(tiny, "eve") == dict.fromkeys(TESTS, 0)
    assert points(tiny, "joe") == {"small": 0, "noisy": 0, "partial": 0, "hidden": 0}
    said = {(row.student, row.exercise): row.diagnosis for row in report.rows}
    assert said["ben", "small"] == "assertion_failed"
    assert said["ada", "partial"] == "partial_credit"
    assert said["eve", "small"] == "kernel_died"
    assert said["joe", "small"] == "syntax_error"
    page = (tiny.path / "feedback" / "ben" / "own" / "own.html").read_text()
    assert "Score: 3.5 / 10.0" in page
    assert "one and two are three" in page
    assert "Remarks of the grader" not in page  # who leaves hidden tests alone has changed nothing
    assert tiny.grade(judge=with_fake_judge).executed == 0


def test_tests_stand_beside_checks_of_the_judge(tiny: TinyClass, with_fake_judge: str) -> None:
    source = tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    notebook: Any = nbformat.read(source, as_version=4)
    notebook.cells += graded_cells()
    nbformat.write(notebook, source)
    release(ClassDirectory(tiny.path))
    tiny.submit("ada", 4, 7)
    tiny.grade(judge=with_fake_judge)
    assert points(tiny, "ada") == {
        "lab_1_2.talker": 4,
        "lab_1_2.listener": 7,
        **dict.fromkeys(TESTS, 0),  # add is not written
        "noisy": 0,
    }


@pytest.mark.parametrize(
    ("value", "score"),
    [("2", 2), ("0", 0), ("2.5", 2.5), ("99", 4), ("-1", 4), ("nan", 4), ("True", 4), ("'text'", 4)],
)
def test_a_value_is_worth_what_nbgrader_takes_it_for(value: str, score: float) -> None:
    outputs = ({"output_type": "execute_result", "data": {"text/plain": value}},)
    verdict = verdict_by_tests(CellCheck("own", "own", 4, 4, 0, asserts=True), CellRun(Ended.DONE, outputs))
    assert verdict is not None
    assert verdict.score == score
    assert verdict.passed is (score == 4)


def test_what_meets_the_stub_of_nbgrader_is_not_solved_yet() -> None:
    for error in ("NotImplementedError: ", "NotImplementedError"):
        verdict = verdict_by_tests(
            CellCheck("own", "own", 4, 4, 0, asserts=True), CellRun(Ended.RAISED, error=error)
        )
        assert verdict is not None
        assert verdict.diagnosis is not None
        assert (verdict.score, verdict.diagnosis.key) == (0, "not_written")
