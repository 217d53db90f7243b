"""An assignment of an instructor's own, as stock nbgrader knows it: a solution, and cells of plain asserts below it."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Any

import nbformat
from nbformat.v4 import new_code_cell, new_notebook
from tiny_class import FakeEngine

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import Cell, CellRun, CellType, Execution
from autograder.execution.verdicts_without_judge import verdict_by_tests, zero_points
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.new_classes.new_class import release
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from tiny_class import TinyClass

    from autograder.grading.grading_task import Task

STUB = cases(__file__, "STUB")
TESTS = cases(__file__, "TESTS")
"""By the cell's name: its text, and its points."""


def marked(cell: Any, name: str, points: int | None) -> Any:
    """A cell as *Create Assignment* marks it: a solution where it has no points, else tests."""
    marks = {"grade": points is not None, "solution": points is None, "locked": points is not None}
    cell.metadata["nbgrader"] = {**marks, "task": False, "schema_version": 3, "grade_id": name}
    if points is not None:
        cell.metadata["nbgrader"]["points"] = points
    return cell


def graded_cells() -> list[Any]:
    """The cells of the assignment."""
    tests = [marked(new_code_cell(source), name, points) for name, (source, points) in TESTS.items()]
    return [marked(new_code_cell(STUB), "add", None), *tests]


def write_assignment(tiny: TinyClass, name: str = "own", cells: Sequence[Any] = ()) -> None:
    """Put an assignment beside the lab, and release it: with plain tests where no other cells are given."""
    notebook = new_notebook(cells=[*(cells or graded_cells())])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    path = tiny.path / "source" / name / f"{name}.ipynb"
    path.parent.mkdir()
    nbformat.write(notebook, path)
    release(ClassDirectory(tiny.path))


def answered(tiny: TinyClass, answer: str, assignment: str = "own") -> str:
    """The released notebook with an answer, as text."""
    notebook: Any = nbformat.read(tiny.path / "release" / assignment / f"{assignment}.ipynb", as_version=4)
    for cell in notebook.cells:
        if cell.metadata.get("nbgrader", {}).get("grade_id") == "add":
            cell.source = answer
    return nbformat.writes(notebook)


def hand_in(tiny: TinyClass, student: str, answer: str, assignment: str = "own") -> Path:
    """Put an answer into ``submitted``."""
    path = tiny.path / "submitted" / student / assignment / f"{assignment}.ipynb"
    path.parent.mkdir(parents=True)
    path.write_text(answered(tiny, answer, assignment), encoding="utf-8")
    return path


class EngineWithAsserts(FakeEngine):
    """Runs plain tests here, by the rules that hold in a box; what a judge decides is told by the answers' text."""

    def execute(self, task: Task) -> Execution:
        """What comes of a notebook."""
        if not any(cell.check and cell.check.asserts for cell in task.cells):
            return super().execute(task)
        names: dict[str, Any] = {}
        runs = tuple(_run(cell, names) for cell in task.cells)
        verdicts = {
            place: verdict_by_tests(cell.check, run)
            or zero_points(cell.check, "crashed", "It raised.", "Mend it.")
            for place, (cell, run) in enumerate(zip(task.cells, runs, strict=True))
            if cell.check is not None
        }
        return Execution(runs, verdicts)


def _run(cell: Cell, names: dict[str, Any]) -> CellRun:
    """A cell as a kernel runs it: the value of a last expression is its result."""
    if cell.kind is not CellType.CODE:
        return CellRun(Ended.DONE)
    try:
        tree = ast.parse(cell.source)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, "cell", "exec"), names)
        value = eval(ast.unparse(last), names) if last else None
    except Exception as error:
        return CellRun(Ended.RAISED, error=f"{type(error).__name__}: {error}")
    result = {"output_type": "execute_result", "metadata": {}, "execution_count": 1}
    return CellRun(Ended.DONE, () if value is None else ({**result, "data": {"text/plain": repr(value)}},))
