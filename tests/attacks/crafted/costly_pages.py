# family = "crafted"
# tries = "A million characters of Markdown and code, each cell below its limit: nested HTML, formulas that open, headings, and attributes of attributes, lines and fields of f-strings for whatever reads code."
# could_earn = "A grader whose own process makes this student's page for minutes, while nobody else is graded."
# undefended = "86 s in the grader's main process for 0.9 MB of Markdown; one cell of code alone took more than a minute."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

SIZE = 49_000
MARKDOWN = ("<div>", "<div>\n\n", "\\\\(", "\\begin{a}", "# a\n", "a\n=\n", "```\n", "> > - ", "[a](", "*a_b")
CODE = ("a.", "x = a.b.c.d.", "import a.", "\n ", "f'" + "{a}" * SIZE)


def hand_in(folder: Path, notebook: Any) -> None:
    for bomb in MARKDOWN:
        notebook.cells.append(nbformat.v4.new_markdown_cell((bomb * SIZE)[:SIZE]))
    for bomb in CODE:
        notebook.cells.append(nbformat.v4.new_code_cell((bomb * SIZE)[:SIZE]))
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
