# family = "forging"
# tries = "Every cell is tagged skip-execution, skip-run, remove-cell and raises-exception, so that check cells are not run, and their outputs of full marks stay."
# could_earn = "All points, where an unexecuted cell keeps its output."
# undefended = "In stock nbgrader 0.9.5 the tag earned full marks."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    for cell in notebook.cells:
        cell.metadata["tags"] = [
            "skip-execution",
            "skip-run",
            "remove-cell",
            "raises-exception",
            "nbval-skip",
        ]
        if cell.cell_type == "code":
            data = {"text/plain": "10.0"}
            cell.outputs = [nbformat.v4.new_output("execute_result", data=data, execution_count=1)]
            cell.execution_count = 1
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
