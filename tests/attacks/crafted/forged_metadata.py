# family = "forging"
# tries = "The metadata of cells and notebook say that the checks are worth a thousand points, need no run, were graded, and that a graded bonus cell is there as well."
# could_earn = "Points that the master does not know."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    for cell in notebook.cells:
        cell.metadata.setdefault("nbgrader", {}).update(
            points=1000, grade=True, solution=True, locked=False, score=1000
        )
        cell.metadata["autograder"] = {"verdict": {"score": 10.0, "state": "passed"}}
    bonus = nbformat.v4.new_code_cell("1000")
    bonus.metadata["nbgrader"] = {
        "grade_id": "bonus", "grade": True, "solution": False, "locked": True, "points": 1000, "schema_version": 3,
        "cell_type": "code", "task": False,
    }  # fmt: skip
    notebook.cells.append(bonus)
    notebook.metadata["autograder"] = {"remarks": [], "problem": "", "verdicts": {"0": {"score": 10.0}}}
    notebook.metadata["celltoolbar"] = "Create Assignment"
    notebook.metadata["nbgrader"] = {"score": 1000}
    folder.joinpath("lab_1_2.ipynb").write_text(nbformat.writes(notebook), encoding="utf-8")
