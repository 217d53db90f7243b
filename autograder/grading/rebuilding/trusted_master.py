"""Reads the trusted master of a submission: the class's source notebook, with stubs instead of solutions."""

from __future__ import annotations

import ast
import contextlib
import functools
import importlib
from typing import TYPE_CHECKING, Any

from nbgrader.converters import GenerateAssignment
from nbgrader.preprocessors import SaveCells
from traitlets.config import Config

from autograder import exercises
from autograder.execution.executed_cells import CellCheck
from autograder.grading.grading_errors import MasterUnusable
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.notebook_rebuilding import grade_id, is_answer, is_check
from autograder.masters.code_cells import find_model_answer
from autograder.masters.master_files import CellError
from autograder.masters.notebook_release import shown_attachments

if TYPE_CHECKING:
    from pathlib import Path

    from nbformat import NotebookNode


def read_master(source: Path, config: Config) -> NotebookNode:
    """Return the notebook that ``nbgrader generate_assignment`` would enter into the gradebook.

    The notebook in ``release/`` cannot be used instead, because it lacks the hidden tests. All callers get the same
    object, so copy it before you change it.

    Args:
        source: The notebook in the class's ``source`` folder.
        config: The class's nbgrader configuration.

    Raises:
        MasterUnusable: The file is not a notebook, two cells have the same name, or a check cell names no exercise.
    """
    try:
        data = source.read_bytes()
    except OSError as error:
        raise MasterUnusable(f"{source} cannot be read: {error.strerror}.") from error
    return _master(source, data, _steps(config))


@functools.lru_cache(maxsize=32)
def _master(source: Path, data: bytes, steps: tuple[str, ...]) -> NotebookNode:
    try:
        notebook = nbformat_nodes.read(data.decode())
    except Exception as error:  # nbformat may raise any error of its JSON and schema libraries
        raise MasterUnusable(
            f"{source} is not a notebook: {error}. Make the notebook again, or restore a copy."
        ) from error
    resources: dict[str, Any] = {}
    rubrics, given = _rubrics(notebook), {grade_id(cell): _given_part(cell.source) for cell in notebook.cells}
    for step in steps:
        try:
            notebook, resources = _step(step)().preprocess(notebook, resources)
        except (
            Exception
        ) as error:  # nbgrader's preprocessors raise various errors, for example if END SOLUTION is missing
            raise MasterUnusable(f"{source} cannot be prepared with nbgrader's steps: {error}") from error
    _check_cells(source, notebook)
    for cell in notebook.cells:
        if is_answer(cell):
            name = grade_id(cell)
            cell.metadata["autograder"] = {**rubrics.get(name, {}), "given": given.get(name, "")}
    return notebook


def _rubrics(source: NotebookNode) -> dict[str, dict[str, Any]]:
    """Return, by grade_id, the model answer and its pictures for each question that a person grades."""
    rubrics = {}
    for cell in source.cells:
        if cell.cell_type == "markdown" and is_answer(cell):
            with contextlib.suppress(CellError):
                text = find_model_answer(cell.source)
                pictures = shown_attachments(text, cell.get("attachments", {}))
                rubrics[grade_id(cell)] = {"rubric": text, "pictures": pictures}
    return rubrics


def _given_part(source: str) -> str:
    """Return the lines of a cell around its solution; empty if the whole cell is the solution."""
    lines = source.splitlines()
    begin = next((place for place, line in enumerate(lines) if "BEGIN SOLUTION" in line), len(lines))
    end = next((place for place, line in enumerate(lines) if "END SOLUTION" in line), 0)
    return "\n".join((*lines[:begin], *lines[end + 1 :])) if begin < end else ""


def check_of(cell: NotebookNode) -> CellCheck | None:
    """Return the check in a cell of a master; None if the cell is not graded automatically.

    Raises:
        LookupError: The cell calls the judge, but its name belongs to no exercise.
    """
    if not is_check(cell):
        return None
    name, worth = grade_id(cell), float(cell.metadata.nbgrader["points"])
    if exercise_of(name) == name and not _asks_the_judge(cell.source):
        return CellCheck(exercise=name, title=name, points=worth, worth=worth, limit=0.0, asserts=True)
    exercise = exercises.get(exercise_of(name))
    return CellCheck(
        exercise=exercise.id,
        title=exercise.title,
        points=exercise.points,
        worth=worth,
        limit=exercise.limit,
    )


def exercise_of(name: str) -> str:
    """Return the id of the exercise that belongs to a cell with this name; the name itself if there is none."""
    return next(
        (exercise_id for exercise_id in exercises.all_ids() if exercises.grade_id(exercise_id) == name), name
    )


def _asks_the_judge(source: str) -> bool:
    """Return True if a graded cell calls ``check``, so that the judge gives its points, not tests in the cell."""
    try:
        tree = ast.parse(source)
    except SyntaxError:
        return "check(" in source  # a cell with a magic cannot be parsed as Python
    return any(
        isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "check"
        for node in ast.walk(tree)
    )


def _check_cells(source: Path, notebook: NotebookNode) -> None:
    names: set[str] = set()
    for cell in notebook.cells:
        name = grade_id(cell)
        if name and name in names:
            raise MasterUnusable(
                f"{source}: two cells have the grade_id {name!r}. Give one of the cells a different grade_id."
            )
        names.add(name)
        try:
            check_of(cell)
        except LookupError as error:
            raise MasterUnusable(
                f"{source}: the cell {name!r} has points, but {error}. The judge gives points only to cells "
                "with an exercise: name the cell after its exercise, or mark it as manually graded."
            ) from error


def _steps(config: Config) -> tuple[str, ...]:
    """Return the names of nbgrader's preprocessors that run before the cells are saved in the gradebook."""
    configured = GenerateAssignment(
        config=Config({"GenerateAssignment": config.GenerateAssignment})
    ).preprocessors
    names = [
        step if isinstance(step, str) else f"{step.__module__}.{step.__qualname__}" for step in configured
    ]
    saving = [place for place, name in enumerate(names) if name.rpartition(".")[2] == SaveCells.__name__]
    return tuple(names[: saving[0]] if saving else names)


def _step(name: str) -> Any:
    module, _, attribute = name.rpartition(".")
    return getattr(importlib.import_module(module), attribute)
