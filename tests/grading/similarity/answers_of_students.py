"""What stands in one cell of a made class: the task, its solution, and what students make of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import nbformat

from tests.cases import cases

if TYPE_CHECKING:
    from tiny_class import TinyClass

STUB = """\
class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        # TODO: publish on /chatter.
"""
SOLUTION = cases(__file__, "SOLUTION")
NEAR = cases(__file__, "NEAR")
ALSO_NEAR = cases(__file__, "ALSO_NEAR")
OF_ONES_OWN = cases(__file__, "OF_ONES_OWN")
COPIED = cases(__file__, "COPIED")
"""The same with other names, texts and comments, a line put in, and its methods in another order."""


def write_task(tiny: TinyClass) -> None:
    """Give the first cell of a tiny class a task worth copying."""
    for folder, text in (("source", f"### BEGIN SOLUTION\n{SOLUTION}### END SOLUTION"), ("release", STUB)):
        path = tiny.path / folder / "lab_1_2" / "lab_1_2.ipynb"
        notebook = nbformat.read(path, as_version=4)
        cell_of(notebook)["source"] = text
        path.write_text(nbformat.writes(notebook), encoding="utf-8")


def hand_in(tiny: TinyClass, student: str, text: str, *own_cells: str) -> None:
    """Have a student hand in an answer to it, and perhaps cells of their own."""
    notebook = tiny.released()
    cell_of(notebook)["source"] = text
    notebook.cells += [nbformat.v4.new_code_cell(source) for source in own_cells]
    tiny.hand_in(student, notebook)


def cell_of(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """The cell with the task."""
    return next(
        cell for cell in notebook.cells if cell.metadata.get("nbgrader", {}).get("grade_id") == "Talker"
    )
