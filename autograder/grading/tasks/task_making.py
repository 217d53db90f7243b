"""Makes the tasks of a submission: one for each notebook, rebuilt and ready to be executed.

Cells that only show something, such as a ``ros2`` command, are skipped when a class is graded.
"""

from __future__ import annotations

import hashlib
import hmac
from collections import Counter
from typing import TYPE_CHECKING, Any

import msgspec

from autograder.execution.executed_cells import Cell, CellType
from autograder.grading.class_checks import limits_of
from autograder.grading.classes.class_directory import SUFFIX, ClassDirectory, Submission
from autograder.grading.course_version import judged_by
from autograder.grading.grading_task import Task
from autograder.grading.rebuilding.notebook_rebuilding import (
    grade_id,
    is_of_another,
    is_the_masters,
    rebuild,
    rebuild_unreadable,
)
from autograder.grading.rebuilding.submission_desk import read_notebook
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes
from autograder.grading.rebuilding.trusted_master import check_of
from autograder.masters.master_cells import CellRole

if TYPE_CHECKING:
    from collections.abc import Iterable

    from nbformat import NotebookNode


LEFT_OUT = "[a demonstration of the notebook: left out while grading]"


def task_of(directory: ClassDirectory, submission: Submission, notebook: str) -> tuple[Task, NotebookNode]:
    """Return the task for one notebook of a submission, and the rebuilt notebook.

    Raises:
        MasterUnusable: The source notebook cannot be used for grading.
    """
    student, assignment = submission.student, submission.assignment
    master = directory.master(assignment, notebook)
    rebuilt, problem = _rebuilt(directory, submission, notebook, master)
    prose = [cell.source for cell in master.cells if cell.cell_type == CellType.MARKDOWN]
    prose += [cell.source for cell in rebuilt.cells[:1] if rebuilt.metadata["autograder"]["remarks"]]
    demonstrations = bool(directory.config.WireExecute.get("demonstrations", False))
    cells = cells_of(rebuilt, demonstrations=demonstrations, prose=prose)
    # The seed must depend on what was handed in. A hash of the whole task would depend on the seed itself, so only the
    # cells are hashed.
    work = hashlib.sha256(msgspec.json.encode(cells)).hexdigest()
    pictures = [
        cell["attachments"] for cell in rebuilt.cells if "attachments" in cell and not is_the_masters(cell)
    ]
    task = Task(
        student=student,
        assignment=assignment,
        notebook=notebook,
        cells=cells,
        seed=seed_for(directory.secret, student, assignment, notebook, work),
        course=judged_by("\n".join(cell.source for cell in master.cells).encode()),
        limits=limits_of(directory),
        files=directory.files(assignment),
        problem=problem,
        remarks=() if problem else tuple(rebuilt.metadata["autograder"]["remarks"]),
        pictures=hashlib.sha256(msgspec.json.encode(pictures)).hexdigest() if pictures else "",
        boxed=not directory.is_sandbox_off,
        overlays=tuple(map(str, directory.overlays)),
    )
    return task, rebuilt


def seed_for(secret: bytes, student: str, assignment: str, notebook: str, work: str) -> str:
    """Return the seed of one student's notebook. The judge derives the seed of each exercise from it.

    Args:
        work: A hash of the submitted cells, so that a changed submission gets different inputs. Otherwise a student
            could copy inputs from the feedback into the next submission.
    """
    # The hashed message contains the lengths of the names, so that ("ab", "c") and ("a", "bc") give different seeds.
    message = "".join(f"{len(part)}:{part};" for part in (student, assignment, notebook, work))
    return hmac.new(secret, message.encode(), hashlib.sha256).hexdigest()[:32]


def _rebuilt(
    directory: ClassDirectory, submission: Submission, notebook: str, master: NotebookNode
) -> tuple[NotebookNode, str]:
    """Return the rebuilt notebook, and the reason if the submitted file was not used (empty if it was used)."""
    path = submission.folder / f"{notebook}{SUFFIX}"
    try:
        cells, left_out = read_notebook(read_bytes(path), directory.state)
        if is_of_another(master, cells):
            raise UnreadableSubmission(
                f"The cells of {path.name} belong to another assignment: hand in the notebook of this assignment."
            )
    except UnreadableSubmission as error:
        return rebuild_unreadable(master, str(error)), str(error)
    others = [one for one in directory.named_cells.assignments(cells) if one != submission.assignment]
    return rebuild(master, cells, left_out, others), ""


def cells_of(
    notebook: NotebookNode, *, demonstrations: bool = True, prose: Iterable[str] = ()
) -> tuple[Cell, ...]:
    """Convert the cells of a rebuilt notebook to the type that the execution uses.

    Args:
        demonstrations: False to empty the cells that only show something, so that they are skipped.
        prose: The texts of the master's text cells, and of the grader's remarks. A cell with such a text counts as
            given, not as the student's. But if a text occurs more often than in ``prose``, the additional cells count
            as the student's, so that a page does not render thousands of copies.
    """
    # A cell that is left out stays, with an empty source: the index of a cell has to be the same everywhere.
    left_out = frozenset() if demonstrations else demonstrations_of(notebook)
    left = Counter(prose)

    def is_given(cell: NotebookNode) -> bool:
        if is_the_masters(cell):
            return True
        given = cell.cell_type == CellType.MARKDOWN and left[cell.source] > 0
        left[cell.source] -= given
        return given

    return tuple(
        Cell(
            source="" if place in left_out else cell.source,
            kind=CellType(cell.cell_type),
            check=check_of(cell),
            name=grade_id(cell),
            own=not is_given(cell),
        )
        for place, cell in enumerate(notebook.cells)
    )


def demonstrations_of(notebook: NotebookNode) -> frozenset[int]:
    """Return the indexes of the cells on which no grade depends.

    Args:
        notebook: A rebuilt notebook.
    """
    earning = [place for place, cell in enumerate(notebook.cells) if _marks(cell).get("grade")]
    last = max(earning, default=len(notebook.cells))

    def writes_or_runs(cell: NotebookNode) -> bool:
        magic = cell.source.partition("\n")[0].partition(" ")[0].strip()
        is_named = cell.cell_type == CellType.CODE and bool(_marks(cell))
        return is_named and magic in ("%%bash", "%%writefile", "%%program")

    return frozenset(
        place
        for place, cell in enumerate(notebook.cells)
        if is_demonstration(cell) or (place > last and writes_or_runs(cell))
    )


def is_demonstration(cell: NotebookNode) -> bool:
    """Return True if a cell comes from the master, and the master marks it as a demonstration.

    Args:
        cell: A cell of a rebuilt notebook. In such a notebook, only cells from the master have nbgrader's metadata.
    """
    given = cell.cell_type == CellType.CODE and is_the_masters(cell) and not _marks(cell).get("grade")
    return given and CellRole.DEMONSTRATION in cell.metadata.get("tags", ())


def _marks(cell: NotebookNode) -> dict[str, Any]:
    marks: dict[str, Any] = cell.metadata.get("nbgrader", {})
    return marks
