"""Reads check cells: which exercise a cell checks, and the points of the exercise."""

from __future__ import annotations

import ast
import difflib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.masters.layout import lab_name
from autograder.masters.master_errors import MasterError

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.masters.parsing import MasterCell

FORM = (
    "A check cell is one line such as: "
    'check("lab_9_1.battery", BatteryNode) or check("lab_9_1.workspace", "ros2_ws")'
)


@dataclass(frozen=True)
class CheckCall:
    """The call ``check("<exercise>", <subject>)`` in a check cell of a master.

    Attributes:
        master: The file of the master.
        line: The line in that file, counted from 1.
        exercise: The exercise's id.
        subject: The subject as Python text: the name of a class or function, or a quoted string.
        is_path: True if the subject is a string, that is, the path of the student's files.
    """

    master: Path
    line: int
    exercise: str
    subject: str
    is_path: bool = False


def read_check(master: Path, cell: MasterCell) -> CheckCall:
    """Return the call in a check cell.

    Raises:
        MasterError: The cell is not one call of ``check``, its exercise belongs to another notebook, or its grade_id is
            wrong.
    """
    exercise, subject, is_path = _call(master, cell)
    if exercise.partition(".")[0] != lab_name(master):
        raise MasterError(
            master,
            cell.line,
            f"The exercise '{exercise}' does not belong to this notebook.",
            f"Exercises of this master begin with '{lab_name(master)}.'.",
        )
    expected = exercises.grade_id(exercise)
    if cell.grade_id is not None and cell.grade_id != expected:
        raise MasterError(
            master,
            cell.line,
            f"The grade_id '{cell.grade_id}' does not match check(\"{exercise}\", …).",
            f"Delete the grade_id: the cell gets '{expected}' automatically.",
        )
    return CheckCall(master, cell.line, exercise, subject, is_path)


def _call(master: Path, cell: MasterCell) -> tuple[str, str, bool]:
    try:
        body = ast.parse(cell.source).body
    except SyntaxError:
        body = []
    match body:
        case [ast.Expr(ast.Call(ast.Name("check"), [ast.Constant(str() as exercise), subject], []))]:
            match subject:
                case ast.Name(name):
                    return exercise, name, False
                case ast.Constant(str() as path):
                    return exercise, repr(path), True
    raise MasterError(master, cell.line, "This check cell cannot be read.", f"{FORM}.")


def exercise_points(check: CheckCall) -> float:
    """Return the points of the exercise that a check cell names.

    Raises:
        MasterError: The exercise does not exist, is broken, or has no points.
    """
    try:
        points = float(exercises.get(check.exercise).points)
    except exercises.UnknownExercise as error:
        near = difflib.get_close_matches(check.exercise, exercises.all_ids(), n=3, cutoff=0.0)
        raise MasterError(
            check.master,
            check.line,
            f"The exercise '{check.exercise}' does not exist.",
            f"Write the exercise in the lab's folder, or name an existing one: {', '.join(near)}.",
        ) from error
    except exercises.BrokenExercise as error:
        raise MasterError(check.master, check.line, f"{error}.", "Correct that file.") from error
    if points <= 0:
        raise MasterError(
            check.master,
            check.line,
            f"The exercise '{check.exercise}' has no points.",
            "Give points to the criteria in the exercise's file.",
        )
    return points
