"""One side of a pair on the page: the lines of an answer with the common passages marked."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from autograder.cards.readable import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from autograder.grading.similarity.own_code import Compared

AROUND = 3
"""Lines that are shown before and behind a marked one."""
_LONGEST_PIECE = 400


@dataclass(frozen=True)
class Piece:
    """A piece of a line.

    Attributes:
        text: What is there, safe to read; a template escapes it for HTML.
        passage: The number of the common passage that it belongs to; 0 for none.
        begins: Whether this is where its number has to stand.
    """

    text: str
    passage: int = 0
    begins: bool = False


@dataclass(frozen=True)
class Line:
    """A line of an answer, or what stands for lines that are left out.

    Attributes:
        number: Counted from 1; 0 where lines are left out.
        pieces: What is in it.
        left_out: How many lines are left out here.
    """

    number: int
    pieces: tuple[Piece, ...] = ()
    left_out: int = 0


@dataclass(frozen=True)
class Stretch:
    """Marked characters of an answer.

    Attributes:
        start: Where they begin.
        end: Where they end.
        passage: The number of the passage, from 1.
        begins: Whether what is marked before it belongs to another passage.
    """

    start: int
    end: int
    passage: int
    begins: bool = True


def stretches(answer: Compared, passages: Iterable[tuple[int, Sequence[bool]]]) -> list[Stretch]:
    """The characters that the words of passages take, in their order in the answer.

    Args:
        answer: One side of a pair.
        passages: The first word of each on that side, and which of its words count.
    """
    found = []
    for number, (first, counts) in enumerate(passages, 1):
        start = None
        for step, counted in enumerate([*counts, False]):
            if counted and start is None:
                start = first + step
            elif not counted and start is not None:
                last = answer.code[first + step - 1]
                found.append(Stretch(answer.code[start].start, last.end, number))
                start = None
    found.sort(key=lambda stretch: stretch.start)
    return [
        replace(stretch, begins=place == 0 or found[place - 1].passage != stretch.passage)
        for place, stretch in enumerate(found)
    ]


def lines(text: str, marked: Sequence[Stretch]) -> list[Line]:
    """The lines with marked passages and those around them."""
    found: list[Line] = []
    offset = 0
    ahead = list(marked)
    for number, line in enumerate(text.split("\n"), 1):
        end = offset + len(line)
        here = [stretch for stretch in _until(ahead, end) if stretch.end > offset]
        found.append(Line(number, tuple(_pieces(line, offset, here))))
        ahead = [stretch for stretch in ahead if stretch.end > end] if here else ahead
        offset = end + 1
    return _near_marks(found)


def _until(ahead: Sequence[Stretch], end: int) -> list[Stretch]:
    here = []
    for stretch in ahead:
        if stretch.start >= end:
            break
        here.append(stretch)
    return here


def _pieces(line: str, offset: int, here: Sequence[Stretch]) -> Iterable[Piece]:
    at = 0
    for stretch in here:
        indent = len(line) - len(line.lstrip())
        start, end = max(stretch.start - offset, indent), min(stretch.end - offset, len(line))
        if end <= start:
            continue
        yield Piece(_readable(line[at:start]))
        yield Piece(_readable(line[start:end]), stretch.passage, stretch.begins and stretch.start >= offset)
        at = end
    yield Piece(_readable(line[at:].rstrip()))


def _near_marks(every: Sequence[Line]) -> list[Line]:
    shown: set[int] = set()
    for place, line in enumerate(every):
        if any(piece.passage for piece in line.pieces):
            shown.update(range(max(0, place - AROUND), min(len(every), place + AROUND + 1)))
    found: list[Line] = []
    before = -1
    for place in [*sorted(shown), len(every)]:
        if place - before > 1:
            found.append(Line(0, left_out=place - before - 1))
        if place < len(every):
            found.append(every[place])
        before = place
    return found


def _readable(text: str) -> str:
    return one_line(text.expandtabs(4), _LONGEST_PIECE)
