"""Finds the cells of a notebook that take too long to render on a page.

A text can be crafted to keep parsers of Markdown and code busy for minutes. So a desk (:mod:`autograder.boxes.desk`)
renders a student's texts in the same steps as nbconvert's page template, and is ended at a limit of processor time. On
pages and in formgrader, the texts that it did not finish are shown as typed, and cut
(:func:`autograder.grading.returning.sanitize.make_harmless`).
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.channel import ChannelClosed
from autograder.boxes.desk import KeptDesk, in_memory
from autograder.grading.rebuilding.submission import HARMLESS_LENGTH

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.execution.cells import Cell

SECONDS = 1
"""The time limit for a notebook, in seconds of processor time. Usual texts take a few hundredths of a second."""
_desk = KeptDesk("autograder.grading.returning.rendering_trial")


def too_costly(cells: Sequence[Cell]) -> tuple[int, ...]:
    """Return the indexes of the cells to show as typed: the first cell that exceeds the time limit, and all after it.

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
