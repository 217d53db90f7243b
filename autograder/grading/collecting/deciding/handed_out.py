"""Distinguishes a student's work from a notebook that is still as it was handed out. A student may send both."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.grading.rebuilding.desk import read_notebook
from autograder.grading.rebuilding.parsing import parse
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from pathlib import Path


def has_work(released: Path, data: bytes) -> bool:
    """Return True if a notebook has a cell that was not handed out.

    If the notebook in ``release`` cannot be read, every notebook counts as containing work. An unreadable notebook
    contains none.

    Args:
        released: The path of the notebook in ``release``.
        data: The bytes that a student handed in.
    """
    try:
        cells, _ = read_notebook(data)
    except UnreadableSubmission:
        return False
    try:
        given = {"", *(cell.source.strip() for cell in parse(read_bytes(released))[0])}
    except UnreadableSubmission:
        return True
    return any(cell.source.strip() not in given for cell in cells)
