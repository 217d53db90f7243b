"""Words that terminal and page share."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.grading.similarity.pairs import Pair

HINT = (
    "A pair is a hint, not a proof: two students may have learnt from each other, or from one page on the web. "
    "Read both answers, and talk with both, before you decide anything."
)


def nothing_found(compared: int) -> str:
    """The sentence where no pair is close."""
    return f"No pair is closer than the task explains ({compared} notebooks compared)."


def percent(pair: Pair) -> str:
    """The share of a pair; rounded down, so that 100 % is all of it."""
    return f"{int(100 * pair.share)} %"


def place(pair: Pair) -> str:
    """In which notebook and cell a pair is."""
    cells = dict.fromkeys((pair.one.answer.cell, pair.other.answer.cell))
    notebook = pair.one.answer.notebook
    return f"{notebook}, {' and '.join(cells)}"
