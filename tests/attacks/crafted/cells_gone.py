# family = "forging"
# tries = "Check cells are deleted, locked cells are gone, solutions come ten times each, and all is in the opposite order."
# could_earn = "Points for checks that are not there, or a batch that ends over them."
# undefended = "In stock nbgrader 0.9.5, one duplicated cell ended the batch (nbgrader issue 1083)."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    kept = [c for c in notebook.cells if c.metadata.get("nbgrader", {}).get("solution")]
    notebook.cells = [nbformat.from_dict({**cell, "id": f"c{n}"}) for n, cell in enumerate((kept * 10)[::-1])]
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
