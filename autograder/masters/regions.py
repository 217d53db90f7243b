"""The solution region of a cell: the part that the student is given and the part that the student writes.

A solution cell of a master looks like this::

    def double(number: int) -> int:
        \"\"\"Twice the number.\"\"\"
        ### BEGIN SOLUTION
        # TODO: return twice the number.
        return 2 * number
        ### END SOLUTION

The comment that opens the region is the stub. It is what remains of the region in the chapter notebook. The
two markers are nbgrader's own, so that a stock nbgrader still finds and clears the region. In a file of XML each of the
three lines is a comment by itself: ``<!-- ### BEGIN SOLUTION -->``.
"""

from __future__ import annotations

from dataclasses import dataclass

from autograder.masters.master_errors import CellError

BEGIN = "### BEGIN SOLUTION"
END = "### END SOLUTION"
TODO = "# TODO: "
ONE_THING = "One cell asks for one thing: split it into two cells."


@dataclass(frozen=True)
class Region:
    """A solution cell, taken apart; each part is a tuple of lines, the two markers are in none of them."""

    before: tuple[str, ...]
    stub: tuple[str, ...]
    answer: tuple[str, ...]
    after: tuple[str, ...]

    @property
    def unsolved(self) -> str:
        """The cell as the student gets it."""
        return "\n".join((*self.before, *self.stub, *self.after))


def mentions_a_region(source: str) -> bool:
    """True if a marker, well written or not, is somewhere in ``source``."""
    return "BEGIN SOLUTION" in source or "END SOLUTION" in source


def find_region(source: str) -> Region:
    """Take a solution cell apart.

    Raises:
        CellError: There is not exactly one well-formed region that opens with a TODO comment.
    """
    lines = source.split("\n")
    begin, end = _marker(lines, BEGIN), _marker(lines, END)
    if end < begin:
        raise CellError(end, f"'{END}' stands before '{BEGIN}'.", "Put the two lines in order.")
    inside = lines[begin + 1 : end]
    length = _stub_length(inside)
    if length == 0:
        raise CellError(
            begin + 1,
            "The region does not open with its stub.",
            f"Begin it with a comment such as '{TODO}create the publisher.'; students get that comment.",
        )
    if not any(line.strip() for line in inside[length:]):
        raise CellError(begin + 1, "The region holds no solution.", "Write it below the TODO comment.")
    _only_one_todo(lines, begin + 1)
    return Region(
        before=tuple(lines[:begin]),
        stub=tuple(inside[:length]),
        answer=tuple(inside[length:]),
        after=tuple(lines[end + 1 :]),
    )


def find_model_answer(source: str) -> str:
    """The region of a question that a person grades: its model answer, and how points are given.

    Raises:
        CellError: There is not exactly one well-formed region with something in it, and a question above it.
    """
    lines = source.split("\n")
    begin, end = _marker(lines, BEGIN), _marker(lines, END)
    if end < begin:
        raise CellError(end, f"'{END}' stands before '{BEGIN}'.", "Put the two lines in order.")
    answer = "\n".join(lines[begin + 1 : end]).strip()
    if not answer:
        raise CellError(begin + 1, "The region holds no answer.", "Write a good one, and what earns points.")
    if not "".join(lines[:begin]).strip():
        raise CellError(begin, "There is no question.", f"Ask it above '{BEGIN}'.")
    return answer


def _marker(lines: list[str], marker: str) -> int:
    """The line of ``marker``, which must be there once, on a line of its own, spelt as it is here."""
    words = marker.removeprefix("### ")
    places = [offset for offset, line in enumerate(lines) if words in line]
    if not places:
        raise CellError(
            0,
            f"A solution cell without '{marker}'.",
            f"Put what students write between '{BEGIN}' and '{END}'.",
        )
    if len(places) > 1:
        raise CellError(
            places[1],
            f"A second '{marker}' in one cell.",
            ONE_THING,
        )
    if _words(lines[places[0]]) != marker:
        raise CellError(places[0], "A marker is misspelt.", f"Its line holds '{marker}' and nothing else.")
    return places[0]


def _stub_length(inside: list[str]) -> int:
    """The number of comment lines that open the region, 0 where the first is no TODO."""
    if not inside or not _words(inside[0]).startswith(TODO):
        return 0
    for offset, line in enumerate(inside):
        if not _words(line).startswith("#"):
            return offset
    return len(inside)


def _words(line: str) -> str:
    """A line without its indentation, and without the two ends of an XML comment that holds all of it."""
    bare = line.strip()
    commented = bare.startswith("<!--") and bare.endswith("-->")
    return bare.removeprefix("<!--").removesuffix("-->").strip() if commented else bare


def _only_one_todo(lines: list[str], stub: int) -> None:
    for offset, line in enumerate(lines):
        if "TODO" in line and offset != stub:
            raise CellError(offset, "A second TODO in one cell.", ONE_THING)
