"""Reading what a student handed in, believing nothing but the text of the cells."""

from __future__ import annotations

import errno
import json
import os
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.boxes.execution import Kind

if TYPE_CHECKING:
    from pathlib import Path

MAX_BYTES = 50_000_000
"""A notebook with many pictures in its outputs has a few megabytes."""
MAX_CELLS = 2_000
MAX_CELL_CHARACTERS = 1_000_000


class UnreadableSubmission(ValueError):
    """The submission cannot be taken as a notebook; the message is a sentence for the student."""


@dataclass(frozen=True)
class SubmittedCell:
    """All that is taken over from a submitted cell.

    Attributes:
        kind: The cell's type as it was submitted.
        source: Its text.
        grade_id: The name it claims to have, empty for none.
    """

    kind: Kind
    source: str
    grade_id: str = ""


def read_bytes(path: Path) -> bytes:
    """The bytes of a submitted notebook.

    Raises:
        UnreadableSubmission: It is missing, no regular file, or too large. Links are not followed: one could
            point at a neighbour's work.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except FileNotFoundError:
        others = (
            sorted(entry.name for entry in path.parent.glob("*.ipynb"))[:3] if path.parent.is_dir() else []
        )
        found = f" Found instead: {', '.join(others)}." if others else ""
        raise UnreadableSubmission(
            f"There is no notebook named {path.name} in the submission.{found}"
        ) from None
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise UnreadableSubmission(f"{path.name} is a link; hand in the notebook itself.") from None
        raise UnreadableSubmission(f"{path.name} could not be opened: {error.strerror}.") from None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise UnreadableSubmission(f"{path.name} is not a file.")
        if status.st_nlink > 1:
            raise UnreadableSubmission(
                f"{path.name} has a second name somewhere (a hard link), so it may be somebody else's work. "
                "Hand in a copy of its own."
            )
        if status.st_size > MAX_BYTES:
            raise UnreadableSubmission(
                f"{path.name} has {status.st_size / 1e6:.0f} MB; the limit is {MAX_BYTES / 1e6:.0f} MB. "
                "Clear its outputs and hand it in again."
            )
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            return file.read(MAX_BYTES + 1)
    finally:
        os.close(descriptor)


def parse(data: bytes) -> tuple[list[SubmittedCell], int]:
    """The cells of a submitted notebook.

    Returns:
        The cells, and how many were left out because they had not the form of a cell.

    Raises:
        UnreadableSubmission: It is no notebook.
    """
    notebook = _decoded(data)
    if not isinstance(notebook, Mapping) or not isinstance(notebook.get("nbformat"), int):
        raise UnreadableSubmission("The file is JSON, but not a Jupyter notebook.")
    cells = _raw_cells(notebook)
    if len(cells) > MAX_CELLS:
        raise UnreadableSubmission(f"The notebook has {len(cells)} cells; the limit is {MAX_CELLS}.")
    taken = [cell for cell in map(_cell, cells) if cell is not None]
    return taken, len(cells) - len(taken)


def _decoded(data: bytes) -> Any:
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UnreadableSubmission(
            f"The file is not a notebook: it is not UTF-8 text (byte {error.start}). "
            "Save the notebook in JupyterLab and hand in that file."
        ) from None
    try:
        return json.loads(text)
    except RecursionError:
        raise UnreadableSubmission("The file is not a notebook: its JSON is nested too deeply.") from None
    except ValueError as error:
        raise UnreadableSubmission(
            f"The file is not a notebook: it is not JSON ({error}). "
            "Save the notebook in JupyterLab and hand in that file."
        ) from None


def _raw_cells(notebook: Mapping[str, Any]) -> list[Any]:
    if notebook["nbformat"] == 3 and isinstance(notebook.get("worksheets"), list):
        sheets = [sheet.get("cells") for sheet in notebook["worksheets"] if isinstance(sheet, Mapping)]
        return [_from_version_3(cell) for cells in sheets if isinstance(cells, list) for cell in cells]
    cells = notebook.get("cells")
    if notebook["nbformat"] != 4 or not isinstance(cells, list):
        raise UnreadableSubmission(
            f"This is no notebook of format 4 (it says format {str(notebook['nbformat'])[:20]})."
        )
    return cells


def _from_version_3(cell: Any) -> Any:
    if not isinstance(cell, Mapping):
        return cell
    return {**cell, "source": cell.get("input", cell.get("source"))}


def _cell(cell: Any) -> SubmittedCell | None:
    if not isinstance(cell, Mapping) or cell.get("cell_type") not in tuple(Kind):
        return None
    source = cell.get("source")
    if isinstance(source, list) and all(isinstance(line, str) for line in source):
        source = "".join(source)
    if not isinstance(source, str) or len(source) > MAX_CELL_CHARACTERS:
        return None
    # A lone surrogate is legal JSON but no text: it could not be written to a file again.
    return SubmittedCell(
        Kind(cell["cell_type"]), source.encode("utf-8", "replace").decode("utf-8"), _grade_id(cell)
    )


def _grade_id(cell: Mapping[str, Any]) -> str:
    metadata = cell.get("metadata")
    nbgrader = metadata.get("nbgrader") if isinstance(metadata, Mapping) else None
    grade_id = nbgrader.get("grade_id") if isinstance(nbgrader, Mapping) else None
    return grade_id.encode("utf-8", "replace").decode("utf-8")[:200] if isinstance(grade_id, str) else ""
