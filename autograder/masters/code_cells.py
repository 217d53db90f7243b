"""Reads code cells: the region that the student writes, and the file or script of a magic.

A solution cell of a master looks like this::

    def double(number: int) -> int:
        \"\"\"Twice the number.\"\"\"
        ### BEGIN SOLUTION
        # TODO: return twice the number.
        return 2 * number
        ### END SOLUTION

The comment at the top of the region is the stub: only the stub remains in the chapter notebook. The two markers are
nbgrader's own, so that nbgrader also finds and clears the region. In XML, each of these lines is a comment:
``<!-- ### BEGIN SOLUTION -->``. If students repair broken code, each line of that code follows the TODO as a comment
that begins with ``#- ``. Students get it as code.

In a cell that begins with ``%%writefile``, a student writes a file of a ROS workspace::

    %%writefile ros2_ws/src/my_robot_pkg/my_robot_pkg/simple_node.py
    import rclpy
    ...
"""

from __future__ import annotations

import re  # noqa: TID251  (not what a student handed in)
import shlex
from dataclasses import dataclass
from pathlib import PurePosixPath

from autograder.masters.master_files import CellError

BEGIN = "### BEGIN SOLUTION"
END = "### END SOLUTION"
TODO = "# TODO: "
BROKEN = re.compile(r"^(\s*)(?:<!-- )?#-(?: (.*?))?(?: -->)?$")
"""Matches a line of broken code: its indentation, and the code; none for an empty line."""
COPIED = "# copied from this notebook: "
"""The beginning of a stub line that is replaced with code from the notebook when the student runs the cell
(:mod:`autograder.notebook.program_magic`).
"""


@dataclass(frozen=True)
class Region:
    """A solution cell, divided into parts. Each part is a tuple of lines, without the two markers."""

    before: tuple[str, ...]
    stub: tuple[str, ...]
    answer: tuple[str, ...]
    after: tuple[str, ...]

    @property
    def is_repair(self) -> bool:
        """True if students get broken code, not only comments about what to write."""
        return any(line.strip() and not _words(line).startswith("#") for line in self.stub)

    @property
    def unsolved(self) -> str:
        """Return the cell as the student gets it."""
        return "\n".join((*self.before, *self.stub, *self.after))

    @property
    def solved(self) -> str:
        """Return the cell with its solution."""
        return "\n".join((*self.before, *self.answer, *self.after))


def mentions_a_region(source: str) -> bool:
    """Return True if ``source`` contains a marker, even a misspelt one."""
    return "BEGIN SOLUTION" in source or "END SOLUTION" in source


def find_region(source: str) -> Region:
    """Split a solution cell into its parts.

    Raises:
        CellError: The cell does not have exactly one well-formed region that begins with a TODO comment.
    """
    lines = source.split("\n")
    begin, end = _markers(lines)
    inside = lines[begin + 1 : end]
    length = _stub_length(inside)
    if length == 0:
        raise CellError(begin + 1, "no_stub")
    if not any(line.strip() for line in inside[length:]):
        raise CellError(begin + 1, "empty_region")
    for offset, line in enumerate(lines):
        if "TODO" in line and offset != begin + 1:
            raise CellError(offset, "second_todo")
    return Region(
        before=tuple(lines[:begin]),
        stub=tuple(
            BROKEN.sub(lambda line: line[1] + line[2] if line[2] else "", one) for one in inside[:length]
        ),
        answer=tuple(inside[length:]),
        after=tuple(lines[end + 1 :]),
    )


def find_model_answer(source: str) -> str:
    """Return the region of a question that a person grades: the model answer, and how to give points.

    Raises:
        CellError: There is not exactly one well-formed, non-empty region, or there is no question above it.
    """
    lines = source.split("\n")
    begin, end = _markers(lines)
    answer = "\n".join(lines[begin + 1 : end]).strip()
    if not answer:
        raise CellError(begin + 1, "no_answer")
    if not "".join(lines[:begin]).strip():
        raise CellError(begin, "no_question")
    return answer


def _markers(lines: list[str]) -> tuple[int, int]:
    """Return the indexes of the lines on which the region begins and ends."""
    begin, end = _marker(lines, BEGIN), _marker(lines, END)
    if end < begin:
        raise CellError(end, "swapped_markers")
    return begin, end


def _marker(lines: list[str], marker: str) -> int:
    """Return the index of the line ``marker``, which must occur exactly once, alone on its line and spelt correctly."""
    words = marker.removeprefix("### ")
    found = [offset for offset, line in enumerate(lines) if words in line]
    if not found:
        raise CellError(0, "no_marker", marker=marker)
    if len(found) > 1:
        raise CellError(found[1], "second_marker", marker=marker)
    if _words(lines[found[0]]) != marker:
        raise CellError(found[0], "misspelt_marker", marker=marker)
    return found[0]


def _stub_length(inside: list[str]) -> int:
    """Return the number of lines of the TODO comment at the top of the region; 0 if there is none."""
    if not inside or not _words(inside[0]).startswith((TODO, COPIED)):
        return 0
    for offset, line in enumerate(inside):
        if not _words(line).startswith("#"):
            return offset
    return len(inside)


def _words(line: str) -> str:
    """Return a line without its indentation, and without the ends of an XML comment around it."""
    bare = line.strip()
    commented = bare.startswith("<!--") and bare.endswith("-->")
    return bare.removeprefix("<!--").removesuffix("-->").strip() if commented else bare


_MAGIC = re.compile(r"%%(?P<name>\w+)[ \t]*(?P<rest>.*)")


@dataclass(frozen=True)
class WrittenFile:
    """The file that a ``%%writefile`` or ``%%program`` cell writes.

    Attributes:
        path: The path of the file, relative to the notebook.
        text: The text of the file, without the line of the magic.
    """

    path: PurePosixPath
    text: str

    @property
    def is_python(self) -> bool:
        """True if the text has to be valid Python."""
        return self.path.suffix == ".py"


def has_magic(source: str) -> bool:
    """Return True if a cell magic, and not Python, executes the cell."""
    return _MAGIC.match(source) is not None


def written_file(source: str) -> WrittenFile | None:
    """Return the file that a cell writes; None for any other cell."""
    magic = _MAGIC.match(source)
    if magic is None or magic["name"] not in ("writefile", "program"):
        return None
    words = shlex.split(magic["rest"])
    if len(words) != 1:
        return None
    return WrittenFile(PurePosixPath(words[0]), source.partition("\n")[2])


def shell_script(source: str) -> str | None:
    """Return the script of a ``%%bash`` cell; None for any other cell."""
    magic = _MAGIC.match(source)
    if magic is None or magic["name"] != "bash":
        return None
    return source.partition("\n")[2]


def python_of(source: str) -> str:
    """Return the Python code of a cell, with an empty line instead of a magic; empty if the cell contains no Python."""
    if not has_magic(source):
        return source
    file = written_file(source)
    return f"\n{file.text}" if file is not None and file.is_python else ""
