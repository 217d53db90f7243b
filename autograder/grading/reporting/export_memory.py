"""What a class has exported: the columns of an LMS's gradebook, and the points in them.

A value in a list of the LMS that differs from the one that was exported last was typed into the LMS by a person.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


class ExportedColumn(msgspec.Struct):
    """A column that was exported.

    Attributes:
        name: The name of the column in the LMS; empty if unknown.
        points: The contents of cells, by student.
    """

    name: str = ""
    points: dict[str, str] = {}


class ExportMemory:
    """The columns that a class has exported, by system and assignment.

    Args:
        state: The class's folder for the autograder's own files.
    """

    def __init__(self, state: Path) -> None:
        self._path = state / "exported.json"
        self._columns: dict[str, dict[str, ExportedColumn]] = {}
        if self._path.exists():
            self._columns = msgspec.json.decode(
                self._path.read_bytes(), type=dict[str, dict[str, ExportedColumn]]
            )

    def column(self, lms: str, assignment: str) -> ExportedColumn:
        """Return what was exported last into the column of an assignment."""
        return self._columns.get(lms, {}).get(assignment, ExportedColumn())

    def note(self, lms: str, assignment: str, name: str, points: Mapping[str, str]) -> None:
        """Remember a column that was exported, in addition to the points of other students."""
        known = self.column(lms, assignment)
        self._columns.setdefault(lms, {})[assignment] = ExportedColumn(
            name or known.name, {**known.points, **points}
        )

    def rename(self, ids: Mapping[str, str]) -> None:
        """Give students other ids.

        Args:
            ids: The new ids by the old ones.

        Raises:
            OSError: The file could not be written.
        """
        for columns in self._columns.values():
            for column in columns.values():
                column.points = {ids.get(one, one): points for one, points in column.points.items()}
        if self._columns:
            self.write()

    def write(self) -> None:
        """Write the file.

        Raises:
            OSError: The file could not be written.
        """
        write_whole(self._path, msgspec.json.encode(self._columns, order="sorted"))
