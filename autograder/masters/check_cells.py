"""Reads check cells: one call, such as ``check("lab_1_2.talker", TalkerNode)``, and the points of its exercise."""

from __future__ import annotations

import ast
import difflib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.masters.master_files import MasterError, lab_name

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.masters.master_cells import MasterCell


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
    exercise, subject, is_path = _check_call(master, cell)
    if exercise.partition(".")[0] != lab_name(master):
        raise MasterError(master, cell.line, "foreign_check", exercise=exercise, lab=lab_name(master))
    expected = exercises.grade_id(exercise)
    if cell.grade_id is not None and cell.grade_id != expected:
        words = {"name": cell.grade_id, "exercise": exercise, "expected": expected}
        raise MasterError(master, cell.line, "grade_id_of_check", **words)
    return CheckCall(master, cell.line, exercise, subject, is_path)


def _check_call(master: Path, cell: MasterCell) -> tuple[str, str, bool]:
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
    raise MasterError(master, cell.line, "unreadable_check")


def exercise_points(check: CheckCall) -> float:
    """Return the points of the exercise that a check cell names.

    Raises:
        MasterError: The exercise does not exist, is broken, or has no points.
    """
    try:
        points = float(exercises.get(check.exercise).points)
    except exercises.UnknownExercise as error:
        # With a cutoff of 0 some names are always suggested, however different they are.
        near = difflib.get_close_matches(check.exercise, exercises.all_ids(), n=3, cutoff=0.0)
        words = {"exercise": check.exercise, "near": ", ".join(near)}
        raise MasterError(check.master, check.line, "unknown_exercise", **words) from error
    except exercises.BrokenExercise as error:
        raise MasterError(check.master, check.line, "broken_file", error=error) from error
    if points <= 0:
        raise MasterError(check.master, check.line, "no_points", exercise=check.exercise)
    return points
