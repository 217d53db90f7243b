"""A budget for the texts of one notebook when a page is made of them.

Parsers of Markdown and of code can be kept busy for minutes by a text that was made for it. So what a student wrote is
rendered for trial by the worker that has executed it, which may be interrupted and holds nobody else up. The trial
takes the same steps as nbconvert's template of a page. What goes beyond the notebook's budget is shown as it was typed
and cut short (:func:`autograder.grading.returning.sanitize.make_harmless`), in nbgrader's pages and in formgrader
alike.
"""

from __future__ import annotations

import gc
import time
from typing import TYPE_CHECKING

from autograder.boxes.execution import Cell, CellType
from autograder.grading.rebuilding.submission import HARMLESS_LENGTH
from autograder.judge.verdicts.deciding import Undecided, limited

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

SECONDS = 0.5
"""Of processor time for a notebook; what students usually write takes a few hundredths."""


def too_costly(cells: Sequence[Cell], seconds: float = SECONDS) -> tuple[int, ...]:
    """The places of the cells that have to be shown as they were typed.

    Call it in a process that may be interrupted, from its main thread.

    Args:
        cells: The cells of a rebuilt notebook.
        seconds: Of processor time for all of them together.
    """
    own = [(place, cell) for place, cell in enumerate(cells) if cell.own and cell.source]
    if sum(len(cell.source) for _, cell in own) <= HARMLESS_LENGTH:
        return ()
    collects = gc.isenabled()
    gc.disable()  # this notebook must not pay for what earlier ones have left
    try:
        return _beyond(seconds, own)
    finally:
        if collects:
            gc.enable()


def _beyond(seconds: float, cells: Sequence[tuple[int, Cell]]) -> tuple[int, ...]:
    """The places of the first cell that goes beyond the budget, and of all behind it."""
    render = _renderer()
    found = []
    left = seconds
    for place, cell in cells:
        began = time.thread_time()
        try:
            if left <= 0:
                raise Undecided
            with limited(left):
                render(cell)
        except Undecided:
            found.append(place)
            left = 0.0
        left -= time.thread_time() - began
    return tuple(found)


def _renderer() -> Callable[[Cell], object]:
    """A function that renders the text of a cell as a page does; its imports are only for those who need it."""
    from bs4 import BeautifulSoup
    from nbconvert.filters.highlight import Highlight2HTML
    from nbconvert.filters.markdown_mistune import markdown2html_mistune
    from nbconvert.filters.strings import clean_html, strip_files_prefix

    from autograder.grading.returning.sanitize import clean, harmless_markdown

    highlight = Highlight2HTML(pygments_lexer="ipython3")

    def render(cell: Cell) -> object:
        # nbconvert/templates/lab/base.html.j2: its blocks "markdowncell" and "input".
        if cell.kind is CellType.CODE:
            piece = clean_html(highlight(cell.source))
        elif cell.kind is CellType.MARKDOWN:
            piece = strip_files_prefix(clean(markdown2html_mistune(harmless_markdown(cell.source))))
        else:
            return None  # shown as it was typed in any case
        return BeautifulSoup(piece, "html.parser")  # nbconvert/exporters/html.py: from_notebook_node

    for kind in (CellType.CODE, CellType.MARKDOWN):
        render(Cell("a <b>", kind))  # lexers and parsers are loaded at their first use
    return render
