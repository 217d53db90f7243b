"""The page: each pair side by side, in one file without script, readable in black and white."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards.readable import one_line
from autograder.grading.returning.page_exporter import POLICY
from autograder.grading.similarity.marked_lines import Line, lines, stretches
from autograder.grading.similarity.pairs import HINT, LEAST_SHARE, SHORTEST, nothing_found
from autograder.grading.similarity.passages import own_words
from autograder.page_templates import page_templates
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from autograder.grading.similarity.close_pairs import Similar
    from autograder.grading.similarity.pairs import Pair

_NAME = "similar.html"
_LONGEST_NAME = 200


@dataclass(frozen=True)
class _Side:
    """An answer of a pair, as the page shows it."""

    student: str
    cell: str
    length: int
    lines: list[Line]


@dataclass(frozen=True)
class _Shown:
    """A pair, as the page shows it."""

    place: str
    percent: str
    shared: int
    sides: tuple[_Side, _Side]


def write_page(found: Similar, to: Path | None = None) -> Path:
    """Write the page about the close pairs of a class.

    Args:
        found: What was found.
        to: The file; ``similar.html`` in the class by default.

    Returns:
        The absolute path of the file.

    Raises:
        OSError: It could not be written.
    """
    to = (to or found.path / _NAME).absolute()
    write_whole(to, page(found).encode())
    return to


def page(found: Similar) -> str:
    """The page about the close pairs of a class."""
    environment = page_templates("autograder.grading.similarity")
    return environment.get_template("similar.html.j2").render(
        policy=POLICY,
        title=found.path.name,
        hint=HINT,
        nothing=nothing_found(found.compared),
        compared=found.compared,
        shortest=SHORTEST,
        least=f"{100 * LEAST_SHARE:g}\N{NO-BREAK SPACE}%",
        pairs=[_shown(pair, found.names) for pair in found.pairs],
        more=found.more,
        lines=[one_line(line, 1000) for line in (*found.notes, *found.troubles)],
    )


def _shown(pair: Pair, names: Mapping[str, str]) -> _Shown:
    counted = [own_words(pair.one, pair.other, passage) for passage in pair.passages]
    starts = (
        (pair.one, [passage.first for passage in pair.passages]),
        (pair.other, [passage.second for passage in pair.passages]),
    )
    left, right = (
        _Side(
            _called(side.answer.student, names),
            side.answer.cell,
            side.length,
            lines(side.answer.text, stretches(side, zip(firsts, counted, strict=True))),
        )
        for side, firsts in starts
    )
    return _Shown(pair.place, pair.percent, pair.shared, (left, right))


def _called(student: str, names: Mapping[str, str]) -> str:
    name = names.get(student)
    return one_line(f"{name} ({student})" if name else student, _LONGEST_NAME)
