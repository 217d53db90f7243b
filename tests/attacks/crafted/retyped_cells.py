# family = "forging"
# tries = "Check cells have become Markdown, solutions raw, and Markdown has become code."
# could_earn = "Points for checks that are not run."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    for cell in notebook.cells:
        kind = {"code": "markdown", "markdown": "code", "raw": "code"}[cell.cell_type]
        if cell.metadata.get("nbgrader", {}).get("solution"):
            kind = "raw"
        cell.cell_type = kind
        for key in ("outputs", "execution_count"):
            cell.pop(key, None)
        if kind == "code":
            cell.outputs, cell.execution_count = [], None
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
