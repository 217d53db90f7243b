# family = "crafted"
# tries = "Text whose conversion into a page takes ages: brackets, emphasis, quotations, tables and HTML that open and never close, half a million characters of each."
# could_earn = "A grader that is busy for hours with one student's page, outside of every box."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

SIZE = 500_000
BOMBS = (
    "[",
    "![",
    "*a **b ",
    "> ",
    "<a ",
    "`",
    "[a](",
    "$",
    "| a ",
    "\\",
    "&",
    "- " * 30 + "\n",
    "<!--",
    "_" * 20 + "a",
)


def hand_in(folder: Path, notebook: Any) -> None:
    for bomb in BOMBS:
        notebook.cells.append(nbformat.v4.new_markdown_cell((bomb * SIZE)[:SIZE]))
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
