"""What the sources of a class carry points for, and whether the gradebook knows it.

Reading a source means running nbgrader's steps on it, which takes a second for a chapter; what came of it is kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from autograder.grading import gradebook
from autograder.grading.errors import ClassIncomplete
from autograder.grading.journal import write_whole

if TYPE_CHECKING:
    from autograder.grading.class_directory import ClassDirectory
    from autograder.grading.fingerprints import Fingerprints


@dataclass(frozen=True)
class GradedCell:
    """A check cell of a source.

    Attributes:
        notebook: The notebook it is in.
        name: Its grade_id.
        exercise: The exercise's id.
        worth: Points it carries.
    """

    notebook: str
    name: str
    exercise: str
    worth: float


@dataclass(frozen=True)
class _Kept:
    fingerprint: str
    cells: dict[str, tuple[GradedCell, ...]]


def graded_cells(directory: ClassDirectory, fingerprints: Fingerprints) -> dict[str, tuple[GradedCell, ...]]:
    """The check cells of each assignment, in the order of the course.

    Raises:
        MasterUnusable: A source cannot be graded against.
    """
    path = directory.state / "sources.json"
    assignments = directory.assignments()
    fingerprint = " ".join(fingerprints.of_sources(assignment) for assignment in assignments)
    try:
        kept = msgspec.json.decode(path.read_bytes(), type=_Kept)
        if kept.fingerprint == fingerprint:
            return kept.cells
    except (OSError, msgspec.MsgspecError):
        pass
    cells = {assignment: tuple(_read(directory, assignment)) for assignment in assignments}
    write_whole(path, msgspec.json.encode(_Kept(fingerprint, cells)))
    return cells


def check_release(directory: ClassDirectory, cells: dict[str, tuple[GradedCell, ...]]) -> None:
    """See that the gradebook knows the cells that the sources have, with the same points.

    Raises:
        ClassIncomplete: There is no assignment, or the gradebook has it otherwise.
    """
    if not cells:
        raise ClassIncomplete(
            f"{directory.path / 'source'} holds no assignment. Put one there, or make a new class."
        )
    for assignment, wanted in cells.items():
        entered = gradebook.worth(directory.gradebook_url, assignment)
        for cell in wanted:
            if entered.get(cell.notebook, {}).get(cell.name) != cell.worth:
                raise ClassIncomplete(
                    f"The gradebook does not know {cell.notebook} as it is in "
                    f"{directory.path / 'source' / assignment}. Enter it: "
                    f"cd {directory.path} && nbgrader generate_assignment {assignment} --force"
                )


def _read(directory: ClassDirectory, assignment: str) -> list[GradedCell]:
    from autograder.grading.master import check_of
    from autograder.grading.rebuild import grade_id

    return [
        GradedCell(notebook, grade_id(cell), check.exercise, check.worth)
        for notebook in directory.notebooks(assignment)
        for cell in directory.master(assignment, notebook).cells
        if (check := check_of(cell)) is not None
    ]
