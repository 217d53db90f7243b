"""Finds the notebook and the assignment of a file from its cells, or else from its name."""

from __future__ import annotations

import functools
from collections import defaultdict
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.collecting.reading.lms_file_names import base_and_number
from autograder.grading.rebuilding.desk import read_notebook
from autograder.grading.rebuilding.submission import UnreadableSubmission

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.rebuilding.named_cells import Target
    from autograder.grading.rebuilding.submission import SubmittedCell

_UNDER = "under assignment in collected.csv"


class NoTarget(ValueError):
    """The notebook of a file is unclear, or is not one to collect now. The message says what to do.

    Args:
        message: The reason, and what to type.
        assignment: The assignment to which the file's cells belong; empty if they do not show it.
        is_left_out: True if the file is not to be collected, because the instructor asked for another assignment, or
            because the class has no assignment with its cells.
    """

    def __init__(self, message: str, assignment: str = "", *, is_left_out: bool = False) -> None:
        super().__init__(message)
        self.assignment = assignment
        self.is_left_out = is_left_out


def is_notebook(name: str, data: bytes) -> bool:
    """Return True if a file is a notebook, judged by its name or its content."""
    head = data[:1000].lstrip(b"\xef\xbb\xbf \t\r\n")
    held = head[:1] == b"{" and b'"nbformat"' in data and (b'"cells"' in data or b'"worksheets"' in data)
    return held or name.lower().endswith(SUFFIX)


def stem_of(name: str) -> tuple[str, int]:
    """Return the name of a notebook without the suffix that programs add, and the number in that suffix."""
    end = name.lower().find(SUFFIX)
    return base_and_number(name[:end] if end > 0 else name.rpartition(".")[0] or name)


class AssignmentOf:
    """Finds notebooks of a class by their names and their cells.

    Args:
        directory: The class.
        asked: The assignment that the instructor named for all files; empty to find it for each file.
    """

    def __init__(self, directory: ClassDirectory, asked: str = "") -> None:
        self._directory = directory
        self._asked = asked

    def is_notebook(self, file: str) -> bool:
        """Return True if a file with this name is a notebook of the class."""
        return stem_of(file)[0].casefold() in self._notebooks

    def named(self, name: str) -> str:
        """Return the assignment that a file's name contains, or that the instructor named; empty if there is none."""
        stem = base_and_number(name.partition(".")[0])[0]
        assignments = {assignment for assignment, _ in self._notebooks.get(stem.casefold(), ())}
        return self._asked or (assignments.pop() if len(assignments) == 1 else "")

    def target(self, name: str, data: bytes) -> tuple[Target, bool]:
        """Return the notebook to which a file belongs, and whether the file's name agrees.

        Args:
            name: The name that the student gave the file.
            data: The content of the file.

        Raises:
            NoTarget: The notebook is unclear; or the cells belong to several notebooks, or to one that contradicts
                the file's name or the instructor.
        """
        named = self._notebooks.get(stem_of(name)[0].casefold(), [])
        cells = _cells(data)
        names = {cell.grade_id for cell in cells} - {""}
        mixed = self._directory.named_cells.assignments(cells)
        if len(mixed) > 1 and self._asked not in mixed:
            raise NoTarget(
                f"it has the cells of {' and of '.join(mixed)}: ask for a notebook of each, or write the one that it "
                f"is to count for {_UNDER}"
            )
        held = self._directory.named_cells.closest(names, self._asked if self._asked in mixed else "")
        meant = [target for target in named if not held or target in held] or held
        here = [target for target in meant if self._asked in ("", target[0])]
        if meant and not here:
            other = meant[0][0]
            why = f"it is not for {self._asked}: it is the notebook of {other}"
            raise NoTarget(f"{why}; to have it there, write {other} {_UNDER}", is_left_out=True)
        if named and not self._asked and not set(named) & set(meant):
            says, other = " or ".join(assignment for assignment, _ in named), held[0][0]
            raise NoTarget(
                f"its name says {says} and its cells are those of {other}: ask for the right notebook, or write "
                f"{other} {_UNDER}",
                other if all(assignment == other for assignment, _ in held) else "",
            )
        if self._asked and not here:
            here = [(self._asked, one) for one in self._directory.notebooks(self._asked)]
        if len(here) != 1:
            # The file has named cells, but none from this class: it is another notebook of the course, such as its
            # summary.
            raise NoTarget(self._unclear(meant), is_left_out=not meant and bool(names))
        return here[0], here[0] in named

    def _unclear(self, meant: list[Target]) -> str:
        """Return why it is unclear which notebook a file is: one of ``meant``, or any of the class if that is empty."""
        assignments = sorted({self._asked} if self._asked else {assignment for assignment, _ in meant})
        if len(assignments) == 1:
            names = ", ".join(self._directory.notebooks(assignments[0]))
            return (
                f"it is not clear which notebook of {assignments[0]} it is ({names}): write that one under notebook in "
                "collected.csv"
            )
        known = f"the class has: {', '.join(self._directory.assignments())}"
        if assignments:
            known = f"notebooks of {' and '.join(assignments)} are called so, or have its cells"
        return f"it is not clear which assignment it is for ({known}): write it {_UNDER}"

    @functools.cached_property
    def _notebooks(self) -> dict[str, list[Target]]:
        """The targets by the name of the notebook, because several assignments may have a notebook with that name."""
        found: dict[str, list[Target]] = defaultdict(list)
        for assignment in self._directory.assignments():
            for name in self._directory.notebooks(assignment):
                found[name.casefold()].append((assignment, name))
        return dict(found)


def _cells(data: bytes) -> Sequence[SubmittedCell]:
    """Return a notebook's cells; none if it cannot be read."""
    try:
        return read_notebook(data)[0]
    except UnreadableSubmission:
        return ()
