# family = "forging"
# tries = "The text of every locked cell is rewritten: checks are the number 10.0, the first cell defines a check of its own."
# could_earn = "All points, where the submission's check cells are run."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.source = "def check(*_): return 10.0\n10.0"
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
