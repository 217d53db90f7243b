"""Lists the cells with points in a class's source notebooks, and compares them with the gradebook.

The list is stored, because it takes a second to make, in which nbgrader's preprocessors run on each source notebook.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.classes import gradebook_reading
from autograder.grading.grading_errors import GradingError, MasterUnusable, course_command
from autograder.grading.grading_task import GradedCell
from autograder.grading.table.rows import NO_EXERCISE

if TYPE_CHECKING:
    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.tasks.result_keys import ResultKeys


@dataclass(frozen=True)
class Released:
    """The cells with points in a class's assignments.

    Attributes:
        cells: The cells with points of each assignment, in the order of the course.
        unusable: The assignments that cannot be graded, with the reason.
    """

    cells: dict[str, tuple[GradedCell, ...]]
    unusable: dict[str, str]


def read_released(directory: ClassDirectory, store: ClassStore, keys: ResultKeys) -> Released:
    """Return the cells with points of all assignments, from the store if the sources are unchanged."""
    fingerprint = keys.of_sources()
    with contextlib.suppress(msgspec.MsgspecError):
        stored = msgspec.json.decode(store.graded_cells(fingerprint), type=dict[str, tuple[GradedCell, ...]])
        return Released(stored, {})
    cells, unusable = {}, {}
    for assignment in directory.assignments():
        try:
            cells[assignment] = tuple(_read(directory, assignment))
        except MasterUnusable as error:
            unusable[assignment] = str(error)
    if not unusable:
        store.keep_graded_cells(fingerprint, msgspec.json.encode(cells))
    return Released(cells, unusable)


def check_release(directory: ClassDirectory, cells: dict[str, tuple[GradedCell, ...]]) -> None:
    """Check that the gradebook contains each cell of the sources with the same points.

    Raises:
        GradingError: The class has no assignment, or the gradebook lacks a cell or has different points for it.
    """
    if not cells:
        raise GradingError(
            f"{directory.path / 'source'} contains no assignment. Put an assignment there, or make a new class."
        )
    for assignment, wanted in cells.items():
        entered = gradebook_reading.max_scores(directory.gradebook_url, assignment)
        for cell in wanted:
            if entered.get(cell.notebook, {}).get(cell.name) != cell.worth:
                command = ("nbgrader", "generate_assignment", assignment, "--force")
                raise GradingError(
                    f"The gradebook does not contain {cell.notebook} as it is in "
                    f"{directory.path / 'source' / assignment}. "
                    f"Enter this version: {course_command(*command, inside=directory.path)}. "
                    "If nbgrader refuses because a student already has points, restore the earlier source, "
                    f"and set points or left-out exercises in {directory.path / 'class.toml'}, which works at "
                    "any time."
                )


def _read(directory: ClassDirectory, assignment: str) -> list[GradedCell]:
    from nbgrader.utils import is_grade, is_task

    from autograder.grading.rebuilding.notebook_rebuilding import grade_id
    from autograder.grading.rebuilding.trusted_master import check_of

    graded_cells = []
    for notebook in directory.notebooks(assignment):
        for cell in directory.master(assignment, notebook).cells:
            name = grade_id(cell)
            if (check := check_of(cell)) is not None:
                graded_cells.append(GradedCell(notebook, name, check.exercise, check.worth))
            elif is_grade(cell) or is_task(cell):
                points = float(cell.metadata.nbgrader["points"])
                graded_cells.append(GradedCell(notebook, name, name, points, by_judge=False))
    names = [cell.exercise for cell in graded_cells]
    twice = next((name for name in names if [*names, *NO_EXERCISE].count(name) > 1), "")
    if twice:
        raise MasterUnusable(
            f"{directory.path / 'source' / assignment}: two lines in the table of points would have the name "
            f"{twice!r}. Give one of the cells another name (grade_id)."
        )
    return graded_cells
