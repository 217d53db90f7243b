# family = "crafted"
# tries = "Code and output whose colouring takes ages: half a million characters of open strings, backslashes, brackets, escape sequences for colours and carriage returns."
# could_earn = "A grader that is busy for hours with one student's page, outside of every box."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

SIZE = 500_000
BOMBS = (
    "'",
    "\\",
    "(",
    'f"{',
    "a" * 50 + ".",
    "0" * 100 + "_",
    "\t \n",
    "#",
    '"""',
    "@a\n",
    "!",
    "%%x\n",
    "?",
)


def hand_in(folder: Path, notebook: Any) -> None:
    for bomb in BOMBS:
        notebook.cells.append(nbformat.v4.new_code_cell((bomb * SIZE)[:SIZE]))
    colours = (
        "import sys\nsys.stdout.write('\\x1b[31m\\x1b[38;5;4' * 50000 + '\\r' * 50000 + '\\x1b[' * 50000)"
    )
    notebook.cells.append(nbformat.v4.new_code_cell(colours))
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
