"""Cells that only show something: left out while a class is graded, because no grade can depend on them.

A chapter shows the ``ros2`` command at work in some forty cells. Each starts processes that take half a second, and all
of them together take longer than everything that a student wrote and the judge looks at. A check runs its subject on a
domain of its own, so that nothing of such a cell reaches it.

The master says which they are, by a tag. A cell that makes something, such as ``colcon build``, is
none, unless it stands below the last cell that earns points. There a notebook has its nodes written into a package,
built and run as programs, which its reader sees and no check looks at: its files and terminals are left out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.boxes.execution import CellType
from autograder.grading.rebuilding.rebuild import is_the_masters
from autograder.masters.parsing import CellRole

if TYPE_CHECKING:
    from nbformat import NotebookNode

    from autograder.grading.classes.class_directory import ClassDirectory

LEFT_OUT = "[a demonstration of the notebook: left out while grading]"


def is_demonstration(cell: NotebookNode) -> bool:
    """True if a cell of a rebuilt notebook only shows something.

    Args:
        cell: Of a rebuilt notebook, in which only the master's own cells carry nbgrader's marks.
    """
    given = cell.cell_type == CellType.CODE and is_the_masters(cell) and not _marks(cell).get("grade")
    return given and CellRole.DEMONSTRATION in cell.metadata.get("tags", ())


def demonstrations_of(notebook: NotebookNode) -> frozenset[int]:
    """The places of the cells that no grade depends on.

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
    """True if the configuration of a class asks for demonstrations to be run."""
    return bool(directory.config.WireExecute.get("demonstrations", False))
