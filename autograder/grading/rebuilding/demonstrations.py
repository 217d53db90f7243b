"""Finds the cells to skip when a class is graded: those that only show something, such as a ``ros2`` command.

The notebooks of a chapter contain about forty such cells, each of which starts processes that take half a second. To
run them would take longer than all student code and checks. They can be skipped because no check depends on them: a
check runs its subject in a separate ROS domain.

The master marks these cells with a tag. But a cell that makes something, for example with ``colcon build``, has no such
tag, because a later check may need the result.

After the last cell with points, all cells that write files or run terminal commands are skipped, too, because no check
follows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.execution.cells import CellType
from autograder.grading.rebuilding.rebuild import is_the_masters
from autograder.masters.parsing import CellRole

if TYPE_CHECKING:
    from nbformat import NotebookNode

    from autograder.grading.classes.class_directory import ClassDirectory

LEFT_OUT = "[a demonstration of the notebook: left out while grading]"


def is_demonstration(cell: NotebookNode) -> bool:
    """Return True if a cell comes from the master, and the master marks it as a demonstration.

    Args:
        cell: A cell of a rebuilt notebook. In such a notebook, only cells from the master have nbgrader's metadata.
    """
    given = cell.cell_type == CellType.CODE and is_the_masters(cell) and not _marks(cell).get("grade")
    return given and CellRole.DEMONSTRATION in cell.metadata.get("tags", ())


def demonstrations_of(notebook: NotebookNode) -> frozenset[int]:
    """Return the indexes of the cells on which no grade depends.

    Args:
        notebook: A rebuilt notebook.
    """
    earning = [place for place, cell in enumerate(notebook.cells) if _marks(cell).get("grade")]
    last = max(earning, default=len(notebook.cells))
    return frozenset(
        place
        for place, cell in enumerate(notebook.cells)
        if is_demonstration(cell) or (place > last and _is_file_or_terminal(cell))
    )


def _marks(cell: NotebookNode) -> dict[str, Any]:
    marks: dict[str, Any] = cell.metadata.get("nbgrader", {})
    return marks


def _is_file_or_terminal(cell: NotebookNode) -> bool:
    magic = cell.source.partition("\n")[0].partition(" ")[0].strip()
    is_own = cell.cell_type == CellType.CODE and bool(_marks(cell))
    return is_own and magic in ("%%bash", "%%writefile", "%%program")


def are_run(directory: ClassDirectory) -> bool:
    """Return True if demonstrations are run in this class (option ``demonstrations`` in its configuration)."""
    return bool(directory.config.WireExecute.get("demonstrations", False))
