"""Work of somebody's in a chapter notebook, which a build must not overwrite."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat
from nbgrader.utils import compute_checksum

if TYPE_CHECKING:
    from pathlib import Path


def holds_work(path: Path) -> bool:
    """True if the notebook has work of a person in it, beyond what a build once wrote.

    A release carries the checksum of each code cell, and of each question, in its metadata: a cell that no longer
    matches was edited, code without one was added. The output of cells is no work. A file that is no notebook counts
    as work: better to ask than to overwrite it.
    """
    if not path.exists():
        return False
    try:
        notebook = nbformat.read(path, as_version=4)
    except Exception:
        # nbformat raises whatever its JSON and schema libraries do.
        return True
    return any(
        _edited(cell) for cell in notebook.cells if cell.cell_type == "code" or "nbgrader" in cell.metadata
    )


def _edited(cell: Any) -> bool:
    tracked = cell.metadata.get("nbgrader", {})
    if "checksum" in tracked:
        return bool(tracked["checksum"] != compute_checksum(cell))
    return bool(cell.source.strip())
