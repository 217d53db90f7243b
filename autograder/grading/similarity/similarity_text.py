"""Prints the similar pairs in a terminal, and converts them for ``similar --json``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from autograder.cards.readable import printable
from autograder.grading.running.progress import plain_line
from autograder.grading.similarity.pairs import HINT, by_students, nothing_found

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.grading.similarity.close_pairs import Similar


def show(found: Similar, page: Path, console: Console | None = None) -> None:
    """Print the pairs, a line for each file that was not compared, and the path of the page.

    Args:
        found: The result of the search.
        page: The path of the page with the pairs side by side.
        console: The console to print on; by default standard output.
    """
    console = console or Console()

    def line(text: str, style: str = "") -> None:
        plain_line(console, printable(text), style)

    if found.pairs:
        console.print(_table(found))
        line(HINT)
    else:
        line(nothing_found(found.compared))
    if found.more:
        line(
            f"note         {found.more} more pairs are less similar and not shown; to see them, compare one "
            "ASSIGNMENT at a time"
        )
    for note in found.notes:
        line(f"note         {note}")
    for trouble in found.troubles:
        line(trouble, "yellow")
    line(f"page       {page}")


def similar_json(found: Similar, page: Path) -> dict[str, Any]:
    """Return the similar pairs and the path of the page, as data for ``similar --json``."""
    pairs = [
        {
            "students": pair.students,
            "place": pair.place,
            "shared_words": pair.shared,
            "own_words": (pair.one.length, pair.other.length),
        }
        for pair in found.pairs
    ]
    return {
        "compared": found.compared,
        "pairs": pairs,
        "more": found.more,
        "notes": found.notes,
        "troubles": found.troubles,
        "page": str(page),
    }


def _table(found: Similar) -> Table:
    shown = Table(header_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    shown.add_column("students", overflow="fold")
    shown.add_column("notebook, cell", overflow="fold")
    shown.add_column("shared", justify="right", no_wrap=True)
    shown.add_column("own words", justify="right", no_wrap=True)
    for pairs in by_students(found.pairs):
        shown.add_row(
            Text(printable(", ".join(pairs[0].students))),
            Text("\n".join(printable(pair.place) for pair in pairs)),
            "\n".join(pair.percent for pair in pairs),
            "\n".join(f"{pair.shared} of {pair.one.length} and {pair.other.length}" for pair in pairs),
        )
    return shown
