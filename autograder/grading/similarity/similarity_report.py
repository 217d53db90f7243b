"""Shows the similar pairs: in a terminal, as data for ``similar --json``, and on a page side by side.

The page is one HTML file without scripts.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

from rich import box
from rich.table import Table
from rich.text import Text

from autograder import standard_output
from autograder.cards.html_rendering import page_templates
from autograder.cards.readable_text import one_line
from autograder.grading.grading_errors import write_output
from autograder.grading.returning.page_exporter import POLICY
from autograder.grading.running.batch_progress import plain_line
from autograder.grading.similarity.similar_pairs import (
    HINT,
    LEAST_SHARE,
    SHORTEST,
    by_students,
    nothing_found,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.similarity.own_words import ComparedAnswer
    from autograder.grading.similarity.similar_pairs import Pair, SimilarPairs


def show(found: SimilarPairs, page: Path) -> None:
    """Print the pairs, a line for each file that was not compared, and the path of the page.

    Args:
        found: The result of the search.
        page: The path of the page with the pairs side by side.
    """
    console = standard_output.console()

    # Names of files and students come from students, and may contain control characters.
    def line(text: str, style: str = "") -> None:
        plain_line(console, text, style)

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


def similar_json(found: SimilarPairs, page: Path) -> dict[str, Any]:
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


def _table(found: SimilarPairs) -> Table:
    shown = Table(header_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    shown.add_column("students", overflow="fold")
    shown.add_column("notebook, cell", overflow="fold")
    shown.add_column("shared", justify="right", no_wrap=True)
    shown.add_column("own words", justify="right", no_wrap=True)
    for pairs in by_students(found.pairs):
        shown.add_row(
            Text(", ".join(pairs[0].students)),
            Text("\n".join(pair.place for pair in pairs)),
            "\n".join(pair.percent for pair in pairs),
            "\n".join(f"{pair.shared} of {pair.one.length} and {pair.other.length}" for pair in pairs),
        )
    return shown


_NAME = "similar.html"
_LONGEST_NAME = 200
_AROUND = 3
"""The number of lines to show before and after a line with a common passage."""
_LONGEST_PIECE = 400


@dataclass(frozen=True)
class _Piece:
    """A piece of a line.

    Attributes:
        text: The text, with control characters made visible. The template escapes the text for HTML.
        passage: The number of the common passage that contains the piece; 0 if no passage contains the piece.
        begins: True if the page shows the passage's number before this piece.
    """

    text: str
    passage: int = 0
    begins: bool = False


@dataclass(frozen=True)
class _Line:
    """A line of an answer; or, if ``number`` is 0, a note that lines were left out.

    Attributes:
        number: The line number, from 1; 0 for a note.
        left_out: For a note, the number of lines that were left out.
    """

    number: int
    pieces: tuple[_Piece, ...] = ()
    left_out: int = 0


def write_page(found: SimilarPairs, to: Path | None = None) -> Path:
    """Write the page about the similar pairs of a class, and return its path.

    Args:
        found: The result of the search.
        to: The file to write; by default ``similar.html`` in the class.

    Returns:
        The absolute path of the file.

    Raises:
        GradingError: The path cannot be used, for example because it is a folder.
        OSError: The file could not be written for another reason.
    """
    to = (to or found.path / _NAME).absolute()
    write_output(to, page_html(found).encode(), "--output")
    return to


def page_html(found: SimilarPairs) -> str:
    """Return the page about the similar pairs of a class, as HTML."""
    environment = page_templates("autograder.grading.similarity")
    return environment.get_template("similar.html.j2").render(
        policy=POLICY,
        title=found.path.name,
        hint=HINT,
        nothing=nothing_found(found.compared),
        compared=found.compared,
        shortest=SHORTEST,
        least=f"{100 * LEAST_SHARE:g}\N{NO-BREAK SPACE}%",
        groups=[[_shown_pair(pair, found.names) for pair in pairs] for pairs in by_students(found.pairs)],
        more=found.more,
        lines=[one_line(line, 1000) for line in (*found.notes, *found.troubles)],
    )


def _shown_pair(pair: Pair, names: Mapping[str, str]) -> dict[str, object]:
    left = [(passage.first, passage.own) for passage in pair.passages]
    right = [(passage.second, passage.own) for passage in pair.passages]
    return {
        "place": pair.place,
        "percent": pair.percent,
        "shared": pair.shared,
        "answers": [_shown_answer(pair.one, left, names), _shown_answer(pair.other, right, names)],
    }


def _shown_answer(
    answer: ComparedAnswer, passages: Iterable[tuple[int, Sequence[bool]]], names: Mapping[str, str]
) -> dict[str, object]:
    own = answer.answer
    return {
        "student": _called(own.student, names),
        "cell": own.cell,
        "length": answer.length,
        "lines": _lines(answer, passages),
    }


def _called(student: str, names: Mapping[str, str]) -> str:
    name = names.get(student)
    return one_line(f"{name} ({student})" if name else student, _LONGEST_NAME)


def _lines(answer: ComparedAnswer, passages: Iterable[tuple[int, Sequence[bool]]]) -> list[_Line]:
    """Return the lines with common passages and the lines around them, with notes for the lines left out.

    Args:
        answer: One answer of a pair.
        passages: For each passage, the index of its first word in this answer, and a list with True for each word to
            mark.
    """
    text = answer.answer.text
    passage_of = [0] * len(text)  # by character
    for number, (first, own) in enumerate(passages, 1):
        for counts, steps in groupby(range(len(own)), key=own.__getitem__):
            if counts:
                words = [answer.code[first + step] for step in steps]
                start, end = words[0].start, words[-1].end
                passage_of[start:end] = [number] * (end - start)
    lines = []
    offset = last = 0
    for number, line in enumerate(text.split("\n"), 1):
        pieces = _pieces(line, passage_of[offset : offset + len(line)], last)
        last = next((piece.passage for piece in reversed(pieces) if piece.passage), last)
        lines.append(_Line(number, pieces))
        offset += len(line) + 1
    return _near_marks(lines)


def _pieces(line: str, passage_of: list[int], last: int) -> tuple[_Piece, ...]:
    """Split a line so that each piece lies in one matching passage or in none.

    ``last`` is the passage to which the end of the previous line belongs.
    """
    indent = len(line) - len(line.lstrip())
    passage_of[:indent] = [0] * indent
    pieces = []
    end = 0
    for passage, characters in groupby(passage_of[: len(line.rstrip())]):
        start, end = end, end + len(list(characters))
        text = one_line(line[start:end].expandtabs(4), _LONGEST_PIECE)
        pieces.append(_Piece(text, passage, begins=passage not in (0, last)))
        last = passage or last
    return tuple(pieces)


def _near_marks(every: Sequence[_Line]) -> list[_Line]:
    marked = [index for index, line in enumerate(every) if any(piece.passage for piece in line.pieces)]
    shown = {near for index in marked for near in range(index - _AROUND, index + _AROUND + 1)}
    near_lines: list[_Line] = []
    for is_shown, numbered in groupby(enumerate(every), key=lambda one: one[0] in shown):
        lines = [line for _, line in numbered]
        near_lines += lines if is_shown else [_Line(0, left_out=len(lines))]
    return near_lines
