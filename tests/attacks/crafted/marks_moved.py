# family = "forging"
# tries = "All metadata is gone, so that cells are recognized by their ids and texts: those of the checks are on cells that print points, and the stubs of the answers are merged into them."
# could_earn = "A check cell, or any other given cell, whose text is the student's."

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    for cell in notebook.cells:
        marks = cell.metadata.pop("nbgrader", {})
        if marks.get("grade"):
            cell.source = f"class TalkerNode: ...\nclass ListenerNode: ...\n{cell.source}\n10.0"
        elif marks.get("solution"):
            cell.source = "def check(*_):\n    return 10.0"
        elif marks:
            cell.source += "\ncheck = lambda *_: 10.0"
    notebook.cells += [
        nbformat.v4.new_code_cell("10.0", id=cell.id) for cell in notebook.cells if "10.0" in cell.source
    ]
    folder.joinpath("lab_1_2.ipynb").write_text(json.dumps(notebook), encoding="utf-8")
