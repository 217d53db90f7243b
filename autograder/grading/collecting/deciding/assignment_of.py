"""Finds the notebook and the assignment of a file from its cells, or else from its name."""

from __future__ import annotations

import functools
from collections import defaultdict
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.collecting.reading.lms_file_names import base_of
from autograder.grading.rebuilding.desk import read_notebook
from autograder.grading.rebuilding.submission import UnreadableSubmission

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.rebuilding.named_cells import Target
    from autograder.grading.rebuilding.submission import SubmittedCell

_UNDER = "under assignment in collected.csv"


class NoTarget(ValueError):
    """The notebook of a file is unclear, or the file is not to be collected now, for the reason in the message.

    Args:
        message: The reason, and what to type.
        is_left_out: True if the file need not be collected: the instructor asked for another assignment, or the class
            has no assignment with the file's cells.
    """

    def __init__(self, message: str, *, is_left_out: bool = False) -> None:
        super().__init__(message)
        self.is_left_out = is_left_out


def is_notebook(name: str, data: bytes) -> bool:
    """Return True if a file is a notebook, judged by its name or its content."""
    head = data[:1000].lstrip(b"\xef\xbb\xbf \t\r\n")
    held = head[:1] == b"{" and b'"nbformat"' in data and (b'"cells"' in data or b'"worksheets"' in data)
    return held or name.lower().endswith(SUFFIX)


def stem_of(name: str) -> str:
    """Return the name of a file without ``.ipynb``, and without what programs add to a copy, such as `` (1)``."""
    end = name.lower().find(SUFFIX)
    return base_of(name[:end] if end > 0 else name.rpartition(".")[0] or name)


class AssignmentOf:
    """Finds out which notebook of a class a collected file is, by the name and the cells of the file.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory

    def is_notebook(self, file: str) -> bool:
        """Return True if a file with this name is a notebook of the class."""
        return stem_of(file).casefold() in self._notebooks

    def notebooks(self, assignment: str) -> list[str]:
        """Return the notebooks of an assignment; none if the class has no assignment with this name."""
        return [
            notebook for several in self._notebooks.values() for of, notebook in several if of == assignment
        ]

    def named(self, name: str, asked: str) -> str:
        """Return ``asked`` or, if that is empty, the assignment in a file's name; empty if there is none."""
        stem = base_of(name.partition(".")[0])
        assignments = {assignment for assignment, _ in self._notebooks.get(stem.casefold(), ())}
        return asked or (assignments.pop() if len(assignments) == 1 else "")

    def target(self, name: str, data: bytes, asked: str) -> tuple[Target, bool]:
        """Return the assignment and the notebook of a file, and whether the file has the notebook's name.

        Args:
            name: The name that the student gave the file.
            data: The content of the file.
            asked: The assignment that the instructor named; empty to find it.

        Raises:
            NoTarget: The notebook is unclear, or the cells belong to several assignments, or they do not belong to the
                assignment in the file's name or to ``asked``.
        """
        named = self._notebooks.get(stem_of(name).casefold(), [])
        cells = _cells(data)
        names = {cell.grade_id for cell in cells} - {""}
        mixed = self._directory.named_cells.assignments(cells)
        if len(mixed) > 1 and asked not in mixed:
            raise NoTarget(
                f"the file has cells of {' and of '.join(mixed)}: ask the student for a notebook for each, or write "
                f"the name of one of these assignments {_UNDER}"
            )
        held = self._directory.named_cells.closest(names, asked if asked in mixed else "")
        meant = [target for target in named if not held or target in held] or held
        here = [target for target in meant if asked in ("", target[0])]
        if meant and not here:
            other = meant[0][0]
            why = f"the file is the notebook of {other}, not of {asked}"
            raise NoTarget(
                f"{why}; to collect the file for {other}, write {other} {_UNDER}", is_left_out=True
            )
        if named and not asked and not set(named) & set(meant):
            says, other = " or ".join(assignment for assignment, _ in named), held[0][0]
            raise NoTarget(
                f"the file's name is that of {says}, but the cells are those of {other}: ask the student for the right "
                f"notebook, or write {other} {_UNDER}"
            )
        if asked and not here:
            here = [(asked, one) for one in self._directory.notebooks(asked)]
        if len(here) != 1:
            # The file has named cells, but none from this class: it is another notebook of the course, such as its
            # summary.
            raise NoTarget(self._unclear(meant, asked), is_left_out=not meant and bool(names))
        return here[0], here[0] in named

    def _unclear(self, meant: list[Target], asked: str) -> str:
        """Return a message with the notebooks or assignments that are possible."""
        assignments = sorted({asked} if asked else {assignment for assignment, _ in meant})
        if len(assignments) == 1:
            names = ", ".join(self._directory.notebooks(assignments[0]))
            which = (
                f"which notebook of {assignments[0]} the file is ({names}): write the notebook under notebook in "
                "collected.csv"
            )
        else:
            known = ", ".join(assignments or self._directory.assignments())
            which = f"which assignment the file is for ({known}): write the assignment {_UNDER}"
        return f"it is not clear {which}"

    @functools.cached_property
    def _notebooks(self) -> dict[str, list[Target]]:
        """Pairs of an assignment and a notebook, by the name of the notebook, which several assignments may use."""
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
