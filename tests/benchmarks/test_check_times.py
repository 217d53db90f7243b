"""What the benchmark of checks takes from notebooks and from the bank."""

from __future__ import annotations

import ast

import pytest

from autograder import exercises
from benchmarks.check_times import definitions, subjects
from tests.cases import cases

PROGRAM = cases(__file__, "PROGRAM")


def test_a_cell_keeps_what_a_program_defines_and_runs_nothing_of_it() -> None:
    assert definitions(PROGRAM) == "import rclpy\nLARGEST = 46\n\ndef main():\n    print(LARGEST)"
    assert "create_node" in definitions(PROGRAM, ast.Assign)
    assert definitions("%%bash\nros2 topic list") == ""


@pytest.mark.parametrize("exercise_id", ["lab_1_2.talker", "exercise_1_2.three_ints", "lab_1_4.server"])
def test_the_solution_of_an_exercise_is_in_the_cells_before_its_check(exercise_id: str) -> None:
    solution = next(subjects(exercise_id))
    compiled = ast.parse("\n".join(solution.cells))
    checked = ast.parse(solution.check).body[0]
    assert isinstance(checked, ast.Expr)
    assert isinstance(checked.value, ast.Call)
    subject = checked.value.args[1]
    assert isinstance(subject, ast.Name)
    assert subject.id in {getattr(node, "name", "") for node in compiled.body}


def test_checks_that_build_a_workspace_are_left_out() -> None:
    built = [name for name in exercises.all_ids() if exercises.get(name).runner]
    assert [list(subjects(name)) for name in built[:3]] == [[], [], []]
