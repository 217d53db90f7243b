"""Finds the cells of a notebook that take too long to render on a page.

A student can craft a text that keeps parsers of Markdown and code busy for minutes. So a desk
(:mod:`autograder.boxes.reading_desks`) renders the texts first as a trial, in the same steps as nbconvert's page
template and with a limit of processor time. If the desk did not finish a text, pages and formgrader show the text as it
was typed, and cut it (:func:`autograder.grading.returning.sanitize.make_harmless`).
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.box_connection import ChannelClosed
from autograder.boxes.reading_desks import KeptDesk, in_memory
from autograder.grading.rebuilding.submitted_notebook import HARMLESS_LENGTH

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.execution.executed_cells import Cell

SECONDS = 1
"""The time limit for all texts of a notebook, in seconds of processor time. Usually they take less than a tenth."""
_desk = KeptDesk("autograder.grading.returning.rendering_trial")


def too_costly(cells: Sequence[Cell]) -> tuple[int, ...]:
    """Return the indexes of the cells to show as typed: the cell at which the time limit is exceeded, and later cells.

    Args:
        cells: The cells of a rebuilt notebook.
    """
    own = [index for index, cell in enumerate(cells) if cell.own and cell.source]
    if sum(len(cells[index].source) for index in own) <= HARMLESS_LENGTH:
        return ()
    texts = [(cells[index].kind, cells[index].source) for index in own]
    try:
        with in_memory(msgspec.json.encode(texts)) as source, in_memory() as answer:
            _desk.ask(source, answer, len(texts), SECONDS)
            done = os.fstat(answer).st_size  # the desk writes one byte after each text
    except ChannelClosed:
        done = 0
    return tuple(own[done:])
