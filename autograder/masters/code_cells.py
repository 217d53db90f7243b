"""The text of a code cell: the region that the student writes, and IPython's magics that make a file or a script of it.

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

A workspace of ROS is made of files, so what a student writes in one may be a file instead of a definition::

    %%writefile ros2_ws/src/my_robot_pkg/my_robot_pkg/simple_node.py
    import rclpy
    ...
"""

from __future__ import annotations

import re  # noqa: TID251  (not what a student handed in)
import shlex
from dataclasses import dataclass
from pathlib import PurePosixPath

from autograder.masters.master_errors import CellError

BEGIN = "### BEGIN SOLUTION"
END = "### END SOLUTION"
TODO = "# TODO: "
ONE_THING = "One cell asks for one thing: split it into two cells."
MAGIC = re.compile(r"%%(?P<name>\w+)[ \t]*(?P<rest>.*)")


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

    @property
    def solved(self) -> str:
        """The cell with its solution, as whoever has solved it has it."""
        return "\n".join((*self.before, *self.answer, *self.after))


def mentions_a_region(source: str) -> bool:
    """True if a marker, well written or not, is somewhere in ``source``."""
    return "BEGIN SOLUTION" in source or "END SOLUTION" in source


def find_region(source: str) -> Region:
    """Take a solution cell apart.

    Raises:
        CellError: There is not exactly one well-formed region that opens with a TODO comment.
    """
    lines = source.split("\n")
    begin, end = _markers(lines)
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
    begin, end = _markers(lines)
    answer = "\n".join(lines[begin + 1 : end]).strip()
    if not answer:
        raise CellError(begin + 1, "The region holds no answer.", "Write a good one, and what earns points.")
    if not "".join(lines[:begin]).strip():
        raise CellError(begin, "There is no question.", f"Ask it above '{BEGIN}'.")
    return answer


def _markers(lines: list[str]) -> tuple[int, int]:
    """The lines on which the region begins and ends."""
    begin, end = _marker(lines, BEGIN), _marker(lines, END)
    if end < begin:
        raise CellError(end, f"'{END}' stands before '{BEGIN}'.", "Put the two lines in order.")
    return begin, end


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


@dataclass(frozen=True)
class WrittenFile:
    """The file that a ``%%writefile`` cell writes.

    Attributes:
        path: Where, relative to the notebook.
        text: The file's text, without the line of the magic.
    """

    path: PurePosixPath
    text: str

    @property
    def is_python(self) -> bool:
        """True if the text has to be Python."""
        return self.path.suffix == ".py"


def has_magic(source: str) -> bool:
    """True if the cell is given to a magic instead of to Python."""
    return MAGIC.match(source) is not None


def written_file(source: str) -> WrittenFile | None:
    """The file that a cell writes, or None for any other cell."""
    magic = MAGIC.match(source)
    if magic is None or magic["name"] != "writefile":
        return None
    words = shlex.split(magic["rest"])
    if len(words) != 1:
        return None
    return WrittenFile(PurePosixPath(words[0]), source.partition("\n")[2])


def shell_script(source: str) -> str | None:
    """The text that a ``%%bash`` cell gives to the shell, or None for any other cell."""
    magic = MAGIC.match(source)
    if magic is None or magic["name"] != "bash":
        return None
    return source.partition("\n")[2]


def python_of(source: str) -> str:
    """The part of a cell that has to be Python, with as many lines: empty where none of it has to."""
    if not has_magic(source):
        return source
    file = written_file(source)
    return f"\n{file.text}" if file is not None and file.is_python else ""
