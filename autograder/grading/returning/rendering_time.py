"""A limit on the time for rendering the texts of one notebook on a page.

A text can be crafted to keep parsers of Markdown and code busy for minutes. So the worker that has executed a
student's notebook also renders the notebook's texts as a trial, because a worker can be interrupted without delaying
other work. The trial takes the same steps as nbconvert's page template. Text beyond the notebook's time limit is
shown as typed and cut (:func:`autograder.grading.returning.sanitize.make_harmless`), both in nbgrader's pages and in
formgrader.
"""

from __future__ import annotations

import gc
import time
from typing import TYPE_CHECKING

from autograder.execution.cells import Cell, CellType
from autograder.grading.rebuilding.submission import HARMLESS_LENGTH
from autograder.judge.verdicts.deciding import Undecided, limited

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

SECONDS = 0.5
"""The limit in seconds of processor time for a notebook. Usual texts take a few hundredths of a second."""


def too_costly(cells: Sequence[Cell], seconds: float = SECONDS) -> tuple[int, ...]:
    """Return the indexes of the cells that must be shown as typed.

    Call this in the main thread of a process that may be interrupted.

    Args:
        cells: The cells of a rebuilt notebook.
        seconds: The limit in seconds of processor time for all cells together.
    """
    own = [(place, cell) for place, cell in enumerate(cells) if cell.own and cell.source]
    if sum(len(cell.source) for _, cell in own) <= HARMLESS_LENGTH:
        return ()
    collects = gc.isenabled()
    # Garbage collection off, so that this notebook's time does not include cleaning up after earlier notebooks.
    gc.disable()
    try:
        return _beyond(seconds, own)
    finally:
        if collects:
            gc.enable()


def _beyond(seconds: float, cells: Sequence[tuple[int, Cell]]) -> tuple[int, ...]:
    """Return the indexes of the first cell that exceeds the limit, and of all cells after it."""
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
    """Return a function that renders a cell's text as a page does. It imports what it needs only when called."""
    from bs4 import BeautifulSoup
    from nbconvert.filters.highlight import Highlight2HTML
    from nbconvert.filters.markdown_mistune import markdown2html_mistune
    from nbconvert.filters.strings import clean_html, strip_files_prefix

    from autograder.grading.returning.sanitize import clean, harmless_markdown

    highlight = Highlight2HTML(pygments_lexer="ipython3")

    def render(cell: Cell) -> object:
        # This follows the blocks "markdowncell" and "input" of nbconvert/templates/lab/base.html.j2.
        if cell.kind is CellType.CODE:
            piece = clean_html(highlight(cell.source))
        elif cell.kind is CellType.MARKDOWN:
            piece = strip_files_prefix(clean(markdown2html_mistune(harmless_markdown(cell.source))))
        else:
            return None  # cells of any other kind are always shown as typed
        return BeautifulSoup(piece, "html.parser")  # nbconvert/exporters/html.py: from_notebook_node

    for kind in (CellType.CODE, CellType.MARKDOWN):
        render(
            Cell("a <b>", kind)
        )  # render once in advance: lexers and parsers are loaded at their first use
    return render
