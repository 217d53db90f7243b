"""The notebook and the assignment that a file is for, as its cells say, or else its name."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.collecting.forms import base_and_number
from autograder.grading.rebuilding.submission import UnreadableSubmission, parse

if TYPE_CHECKING:
    from autograder.grading.classes.class_directory import ClassDirectory

Target = tuple[str, str]
"""An assignment, and one of its notebooks."""


class NoTarget(ValueError):
    """It is not clear which notebook a file is, or it is one that was not asked for; the message says what to do.

    Args:
        message: The reason, and what to type.
        assignment: The assignment that its cells are of; empty where they do not say it.
        is_left_out: Whether the instructor has asked for another assignment, so that it is left out on purpose.
    """

    def __init__(self, message: str, assignment: str = "", *, is_left_out: bool = False) -> None:
        super().__init__(message)
        self.assignment = assignment
        self.is_left_out = is_left_out


def is_notebook(name: str, data: bytes) -> bool:
    """True if a file is a notebook: by its name, or by what it holds, whatever its name is."""
    head = data[:1000].lstrip(b"\xef\xbb\xbf \t\r\n")
    held = head[:1] == b"{" and b'"nbformat"' in data and (b'"cells"' in data or b'"worksheets"' in data)
    return held or name.lower().endswith(SUFFIX)


def stem_of(name: str) -> tuple[str, int]:
    """The name of a notebook without what programs put behind it, and the number that they added."""
    end = name.lower().find(SUFFIX)
    return base_and_number(name[:end] if end > 0 else name.rpartition(".")[0] or name)


class AssignmentOf:
    """Knows the notebooks of a class by their names and by their cells.

    Args:
        directory: The class.
        asked: The assignment that the instructor says all is for; empty where files say it themselves.
    """

    def __init__(self, directory: ClassDirectory, asked: str = "") -> None:
        self._directory = directory
        self._asked = asked
        self.notes: list[str] = []
        """A sentence on each source of the class that cannot be read."""

    def is_notebook(self, file: str) -> bool:
        """True if a file of this name is a notebook of the class."""
        return stem_of(file)[0].casefold() in self._notebooks

    def named(self, name: str) -> str:
        """The assignment that the name of any file speaks of, or the instructor does; empty where neither does."""
        stem = base_and_number(name.partition(".")[0])[0]
        return self._asked or self._notebooks.get(stem.casefold(), ("", ""))[0]

    def target(self, name: str, data: bytes) -> tuple[Target, bool]:
        """The notebook that a file is, and whether its name says so, too.

        Args:
            name: The name that the student gave it.
            data: What it holds.

        Raises:
            NoTarget: Nothing says which; or its cells are those of another one than its name or the instructor says.
        """
        named = self._notebooks.get(stem_of(name)[0].casefold())
        held = self._by_its_cells(data)
        if self._asked:
            target = self._of_asked(named, held)
        elif named is not None and held and named not in held:
            other = held[0][0]
            raise NoTarget(
                f"its name says {named[0]} and its cells are those of {other}: ask for the right notebook, or collect "
                f"it alone and say --assignment {other}",
                other if all(assignment == other for assignment, _ in held) else "",
            )
        else:
            target = named or (held[0] if len(held) == 1 else None)
        if target is None:
            known = ", ".join(self._directory.assignments())
            raise NoTarget(
                f"it is not clear which assignment it is for (the class has: {known}): say --assignment NAME"
            )
        return target, target == named

    def _of_asked(self, named: Target | None, held: list[Target]) -> Target | None:
        """The notebook of the assignment that was asked for; None where it has several and nothing says which."""
        said = [named] if named and (not held or named in held) else held
        if said and self._asked not in {assignment for assignment, _ in said}:
            other = said[0][0]
            raise NoTarget(
                f"it is not for {self._asked}: it is the notebook of {other}; to have it there, collect it and say "
                f"--assignment {other}",
                is_left_out=True,
            )
        here = [target for target in said if target[0] == self._asked]
        notebooks = self._directory.notebooks(self._asked)
        if named in here or len(here) == 1:
            return named if named in here else here[0]
        return (self._asked, notebooks[0]) if len(notebooks) == 1 else None

    def _by_its_cells(self, data: bytes) -> list[Target]:
        """The notebooks that have most of its named cells; none where its cells have no names of the class."""
        try:
            names = {cell.grade_id for cell in parse(data)[0] if cell.grade_id}
        except UnreadableSubmission:
            return []
        shared = {target: len(names & own) for target, own in self._grade_ids.items()}
        most = max(shared.values(), default=0)
        return [target for target, count in shared.items() if most and count == most]

    @functools.cached_property
    def _notebooks(self) -> dict[str, Target]:
        """Assignment and notebook by the notebook's name."""
        return {
            notebook.casefold(): (assignment, notebook)
            for assignment in self._directory.assignments()
            for notebook in self._directory.notebooks(assignment)
        }

    @functools.cached_property
    def _grade_ids(self) -> dict[Target, set[str]]:
        """The names of the cells of each notebook, as they are handed out; none of one that cannot be read."""
        found: dict[Target, set[str]] = {}
        for assignment, notebook in self._notebooks.values():
            path = self._directory.path / "source" / assignment / f"{notebook}{SUFFIX}"
            try:
                cells, _ = parse(path.read_bytes())
            except UnreadableSubmission as error:
                cells = []
                self.notes.append(
                    f"{path} cannot be read ({error}): what is for it is told by file names alone"
                )
            found[assignment, notebook] = {cell.grade_id for cell in cells} - {""}
        return found
