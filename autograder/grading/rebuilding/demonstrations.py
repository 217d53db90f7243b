"""Cells that only show something. They are skipped when a class is graded, because no grade depends on them.

A chapter shows the ``ros2`` command in some forty cells. Each of these starts processes that take half a second, and
together they take longer than all student code and checks. A check runs its subject in a separate ROS domain, so such
a cell cannot affect the check.

The master marks these cells with a tag. A cell that makes something, such as ``colcon build``, is not a demonstration,
because a later check may need the result.

Below the last cell with points, no check follows. There, notebooks write their nodes into a package, and build and run
them as programs. So all cells with files and terminals are skipped there, too.
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
    """Return True if a cell of a rebuilt notebook only shows something.

    Args:
        cell: A cell of a rebuilt notebook. Only cells that come from the master have nbgrader's metadata there.
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
    """Return True if the configuration of a class asks for demonstrations to be run."""
    return bool(directory.config.WireExecute.get("demonstrations", False))
